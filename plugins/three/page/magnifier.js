// A magnifier at true pixels: the same few pixels of every variant, side by side, each pixel as a square.
import { spans } from './spans.js';
import { TITLES } from './variants.js';

/** Screen pixels along the side of a magnified pixel. */
const SCALE = 8;
/** Largest side of a tile, and the gap around tiles, in CSS pixels. */
const [LARGEST, GAP] = [176, 8];
/** CSS pixels at the top and at the bottom of the frame that labels and buttons need. */
const [ABOVE, BELOW] = [40, 60];

export class Magnifier {
  isOn = false;
  /** Where the magnifier looks, in CSS pixels from the upper left of the frame; null is the centre. */
  at = null;

  /** `tiles` holds the frames and titles of the tiles, and `mark` shows the pixels that are magnified. */
  constructor({ tiles, mark }) {
    Object.assign(this, { tiles, mark });
  }

  move(dx, dy, { width, height }) {
    const { x, y } = this.at ?? { x: width / 2, y: height / 2 };
    this.at = { x: Math.min(Math.max(x + dx, 0), width), y: Math.min(Math.max(y + dy, 0), height) };
  }

  /**
   * Places the tiles of the variants `names`.
   *
   * @param {number[]} box The picture that the magnifier is over: [x, y, width, height] from the lower left.
   * @returns {{ name: string, box: number[], part: number[] }[]} What to draw where.
   */
  place(names, box, { width, height, ratio }) {
    this.tiles.hidden = this.mark.hidden = !this.isOn;
    if (!this.isOn) return [];
    const largest = [LARGEST, (width - GAP) / names.length - GAP, height / 2 - BELOW - GAP];
    const side = Math.max(Math.floor(Math.min(...largest)), 1);
    const { x, y } = this.at ?? { x: box[0] + box[2] / 2, y: height - box[1] - box[3] / 2 };
    // The pixel in the centre, in the picture, from the lower left; and the number of pixels along a side.
    const [px, py] = [x - box[0], height - y - box[1]].map((of) => Math.floor(of * ratio));
    const shown = (side * ratio) / SCALE;
    const [w, h] = [box[2], box[3]].map((of) => Math.round(of * ratio));
    const first = [px, py].map((of) => of - Math.floor(shown / 2));
    const part = [first[0] / w, first[1] / h, shown / w, shown / h];
    // The tiles lie in the half in which the magnifier does not look.
    const top = y < height / 2 ? height - BELOW - side - GAP : ABOVE;
    const left = Math.floor((width - names.length * (side + GAP) + GAP) / 2);
    const placed = names.map((name, i) => ({ name, x: left + i * (side + GAP), y: top }));
    spans(
      this.tiles,
      placed.map(({ name, x, y }) => ({
        text: TITLES[name],
        style: { left: `${x}px`, top: `${y}px`, width: `${side}px`, height: `${side}px` },
      })),
    );
    const marked = shown / ratio;
    Object.assign(this.mark.style, {
      left: `${x - marked / 2}px`,
      top: `${y - marked / 2}px`,
      width: `${marked}px`,
      height: `${marked}px`,
    });
    return placed.map((tile) => ({ name: tile.name, box: [tile.x, height - tile.y - side, side, side], part }));
  }
}
