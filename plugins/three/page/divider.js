// The line between two pictures: dragged on the picture, or moved by keys.

/** Shares of the width by which keys move the divider. */
const [STEP, PAGE] = [0.01, 0.1];

export class Divider {
  /** The place of the line, as a share of the width. */
  value = 0.5;

  /** Calls `changed` when the line has moved. */
  constructor(element, changed) {
    Object.assign(this, { element, changed });
    element.addEventListener('pointerdown', (event) => {
      event.preventDefault();
      element.focus();
      element.setPointerCapture(event.pointerId);
    });
    element.addEventListener('pointermove', (event) => {
      if (!element.hasPointerCapture(event.pointerId)) return;
      const { left, width } = element.parentElement.getBoundingClientRect();
      this.set((event.clientX - left) / width);
    });
    element.addEventListener('keydown', (event) => this.#key(event));
    this.#place();
  }

  /** Moves the line to a share of the width, which is limited to [0, 1]. */
  set(value) {
    this.value = Math.min(Math.max(value, 0), 1);
    this.#place();
    this.changed();
  }

  #place() {
    const percent = Math.round(100 * this.value);
    this.element.style.left = `${100 * this.value}%`;
    this.element.setAttribute('aria-valuenow', percent);
    this.element.setAttribute('aria-valuetext', `${percent} % of the width`);
  }

  step(by) {
    this.set(this.value + by);
  }

  #key(event) {
    const moves = {
      ArrowLeft: this.value - STEP,
      ArrowDown: this.value - STEP,
      ArrowRight: this.value + STEP,
      ArrowUp: this.value + STEP,
      PageDown: this.value - PAGE,
      PageUp: this.value + PAGE,
      Home: 0,
      End: 1,
    };
    if (!(event.key in moves)) return;
    event.preventDefault();
    this.set(moves[event.key]);
  }
}
