// The form, the keyboard and the pointer, which change what is shown.

/** Maps 0 to 100 of the slider to units; the farthest distance is 60 times the nearest. */
const distanceOf = (value) => 2.2 * 60 ** (value / 100);

const SHOWN = {
  distance: (v) => distanceOf(v).toFixed(1),
  environmentIntensity: (v) => `${v} %`,
  intensity: (v) => (v / 100).toFixed(1),
  level: (v) => (v < 0 ? 'auto' : String(v)),
};
const degrees = (v) => `${v}°`;

export class Controls {
  /** Calls `changed` with the name of the control that changed. */
  constructor({ form, canvas, split, changed }) {
    Object.assign(this, { form, canvas, split, changed });
    form.addEventListener('input', ({ target }) => this.#notify(target.name));
    form.addEventListener('submit', (event) => event.preventDefault());
    split.addEventListener('input', () => this.#notify('split'));
    canvas.addEventListener('keydown', (event) => this.#key(event));
    canvas.addEventListener(
      'wheel',
      (event) => {
        event.preventDefault();
        this.step('distance', 0.02 * event.deltaY);
      },
      { passive: false },
    );
    canvas.addEventListener('pointerdown', (event) => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener('pointermove', (event) => {
      if (!canvas.hasPointerCapture(event.pointerId)) return;
      this.step('azimuth', -0.4 * event.movementX);
      this.step('elevation', 0.4 * event.movementY);
    });
    for (const element of form.elements) if (element.name) this.#label(element.name);
  }

  /** Returns a value, as a number where it is one. */
  value(name) {
    const element = name === 'split' ? this.split : this.form.elements[name];
    return element.type === 'range' ? Number(element.value) : element.value;
  }

  get distance() {
    return distanceOf(this.value('distance'));
  }

  /** Fills a list, and selects the wanted entry if the list has it. */
  options(name, values, wish) {
    this.form.elements[name].replaceChildren(...values.map((value) => new Option(value, value, false, value === wish)));
  }

  step(name, by) {
    const element = name === 'split' ? this.split : this.form.elements[name];
    const around = name === 'azimuth' && Math.abs(Number(element.value) + by) > 180 ? -360 * Math.sign(by) : 0;
    element.value = Number(element.value) + by + around;
    this.#notify(name);
  }

  #next(name) {
    const element = this.form.elements[name];
    element.selectedIndex = (element.selectedIndex + 1) % element.length;
    this.#notify(name);
  }

  #notify(name) {
    this.#label(name);
    this.changed(name);
  }

  #label(name) {
    const output = this.form.elements[name]?.closest?.('label')?.querySelector('output');
    if (output) output.value = (SHOWN[name] ?? degrees)(this.value(name));
  }

  #key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const actions = {
      ArrowLeft: () => this.step('azimuth', -5),
      ArrowRight: () => this.step('azimuth', 5),
      ArrowUp: () => this.step('elevation', 5),
      ArrowDown: () => this.step('elevation', -5),
      '+': () => this.step('distance', -4),
      '=': () => this.step('distance', -4),
      '-': () => this.step('distance', 4),
      '[': () => this.step('split', -50),
      ']': () => this.step('split', 50),
      v: () => this.#next('view'),
      l: () => this.#next('layout'),
    };
    const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!action) return;
    event.preventDefault();
    action();
  }
}
