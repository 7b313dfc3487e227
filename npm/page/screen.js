// What is on the screen: two pictures on both sides of a divider, or all three side by side.
import * as THREE from 'three';
import { Composer } from './viewer/compose.js';

/** The pictures, in the order in which they are shown. */
export const NAMES = ['before', 'baked', 'supersampled'];
/** The composer's view that shows colours as they are. */
const SHADED = 0;

/**
 * @typedef {{ layout: 'all' | 'divider', left: string, right: string, split: number }} Look
 * @typedef {{ name: string, box: number[], window: number[] }} Place
 *   A picture fills `box` and is clipped by `window`: [x, y, width, height] in CSS pixels from the lower left.
 */

/**
 * Returns where each picture is on a screen of `width` times `height` CSS pixels.
 *
 * @param {Look} look
 * @returns {Place[]}
 */
export function places({ layout, left, right, split }, width, height) {
  if (layout === 'divider') {
    const box = [0, 0, width, height];
    const x = Math.round(width * split);
    return [
      { name: left, box, window: [0, 0, x, height] },
      { name: right, box, window: [x, 0, width - x, height] },
    ];
  }
  const isWide = width > height;
  const [w, h] = isWide ? [Math.floor(width / NAMES.length), height] : [width, Math.floor(height / NAMES.length)];
  return NAMES.map((name, i) => {
    const box = isWide ? [i * w, 0, w, h] : [0, height - (i + 1) * h, w, h];
    return { name, box, window: box };
  });
}

export class Screen {
  constructor(renderer) {
    this.composer = new Composer(renderer, new THREE.Color(0.02, 0.02, 0.022));
  }

  /** Draws pictures at their places. `pictureOf` returns the texture of a name and the samples in its sum. */
  show(places, pictureOf) {
    for (const { name, box, window } of places) {
      const picture = pictureOf(name);
      if (window[2] > 0) this.composer.draw(picture, picture, SHADED, { box, window });
    }
  }
}
