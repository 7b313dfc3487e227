// What is on the screen: pictures side by side or on both sides of the divider, their labels, and the magnifier.
import { Composer } from './compose.js';
import { VIEWS } from './debug.js';
import { spans } from './spans.js';
import { TITLES } from './variants.js';

/** The view after those of `debug.js`. */
const DIFFERENCE = VIEWS.length;

export class Screen {
  #size = {};

  /** `frame` holds the canvas and what lies on it. */
  constructor({ renderer, frame, labels, background, divider, magnifier }) {
    Object.assign(this, { renderer, frame, labels, divider, magnifier });
    this.composer = new Composer(renderer, background);
  }

  /**
   * Returns boxes of pictures in CSS pixels from the lower left, and the windows that clip them.
   *
   * @param {{ layout: string, left: string, right: string, names: string[] }} what
   */
  places({ layout, left, right, names }) {
    const { width, height } = this.#size;
    if (layout === 'slider') {
      const x = Math.round(width * this.divider.value);
      const box = [0, 0, width, height];
      return [
        { name: left, box, window: [0, 0, x, height], label: { left: '0.6rem', top: '0.6rem' } },
        { name: right, box, window: [x, 0, width - x, height], label: { right: '0.6rem', top: '0.6rem' } },
      ];
    }
    const [columns, rows] =
      width > 1.2 * height ? [names.length, 1] : [Math.min(2, names.length), Math.ceil(names.length / 2)];
    const [w, h] = [Math.floor(width / columns), Math.floor(height / rows)];
    return names.map((name, i) => {
      const [column, row] = [i % columns, Math.floor(i / columns)];
      const box = [column * w, height - (row + 1) * h, w, h];
      const label = { left: `calc(${column * w}px + 0.6rem)`, top: `calc(${row * h}px + 0.6rem)` };
      return { name, box, window: box, label };
    });
  }

  /** Follows the size of the frame. Returns the size in CSS pixels, with `ratio` screen pixels in each. */
  fit() {
    const { clientWidth: width, clientHeight: height } = this.frame;
    const ratio = Math.min(devicePixelRatio, 2);
    if (width !== this.#size.width || height !== this.#size.height || ratio !== this.#size.ratio) {
      this.#size = { width, height, ratio };
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(width, height, false);
    }
    return this.#size;
  }

  /** Shows `pictures` at `places`, and the magnified pixels of all `names`. */
  show({ pictures, places, names, view, exposure, errorOf }) {
    const truth = pictures.get('supersampled');
    const index = view === 'difference' ? DIFFERENCE : Math.max(VIEWS.indexOf(view), 0);
    this.composer.exposure = exposure;
    for (const { name, box, window } of places) {
      if (window[2] > 0) this.composer.draw(pictures.get(name), truth, index, { box, window });
    }
    for (const { name, box, part } of this.#tiles(places, names))
      this.composer.draw(pictures.get(name), truth, index, { box, part });
    spans(
      this.labels,
      places.map(({ name, label }) => {
        const error = errorOf(name);
        return { text: error ? `${TITLES[name]} · error ${error}` : TITLES[name], style: label };
      }),
    );
  }

  #tiles(places, names) {
    const { x, y } = this.magnifier.at ?? { x: 0, y: 0 };
    const fromBelow = this.#size.height - y;
    const isOver = ({ box: [left, bottom, width, height] }) =>
      x >= left && x < left + width && fromBelow >= bottom && fromBelow < bottom + height;
    return this.magnifier.place(names, (places.find(isOver) ?? places[0]).box, this.#size);
  }
}
