// Runs in the browser: draws the variants and the truth, and measures errors.
import * as THREE from 'three';
import { Stage } from '/page/stage.js';
import { flicker, relativeL1, ssim } from '/looks/errors.js';

const DRAWN = ['original', 'portable', 'reflected', 'pyramid'];
const LIGHT = { azimuth: 150, elevation: 40, intensity: 3 };
const CAMERA = { azimuth: 0, elevation: 35 };
/** Degrees that the camera turns from frame to frame of a sequence. */
const STEP = 0.15;

const renderer = new THREE.WebGLRenderer();
renderer.setClearAlpha(0);
export const stage = new Stage(renderer);

/** Returns the pixels of a target: RGBA in floats. */
export const read = (target) => {
  const { width, height } = target;
  const pixels = new Float32Array(4 * width * height);
  renderer.readRenderTargetPixels(target, 0, 0, width, height, pixels);
  return pixels;
};

/** Draws a variant with one sample per pixel. */
export function pictureOf(name, size) {
  const target = new THREE.WebGLRenderTarget(size, size, { type: THREE.FloatType });
  stage.draw(name, target);
  const pixels = read(target);
  target.dispose();
  return pixels;
}

/** Draws variants from one camera, under one light in a room. */
function draw(names, size, view) {
  stage.environment('room');
  stage.light(LIGHT);
  stage.resize(size, size);
  stage.look(view);
  return names.map((name) => pictureOf(name, size));
}

/** Draws every variant and the truth from one camera. Edges of the subject, which alias, are black in all pictures. */
function pictures(size, samples, view, names = DRAWN) {
  const drawn = draw(names, size, view);
  stage.accumulator.reset(size, size);
  stage.accumulate(samples);
  const truth = read(stage.accumulator.target).map((value) => value / samples);
  for (let i = 0; i < truth.length; i += 4) {
    if (truth[i + 3] < 0.999) [truth, ...drawn].forEach((picture) => picture.fill(0, i, i + 3));
  }
  return { drawn, truth };
}

/** Loads variants, from URLs by name. */
window.load = (urls) => stage.load(urls);

/** Returns the errors of all variants, or of `names`, at a distance: [[relative L1, SSIM], ...]. */
window.errors = ({ kind, distance, size, samples, names }) => {
  stage.show(kind);
  const { drawn, truth } = pictures(size, samples, { ...CAMERA, distance }, names);
  return drawn.map((picture) => [relativeL1(picture, truth), ssim(picture, truth, size)]);
};

/** Returns the relative L1 between two variants. */
window.apart = ({ kind, distance, size, names }) => {
  stage.show(kind);
  return relativeL1(...draw(names, size, { ...CAMERA, distance }));
};

/** Returns the flicker of each variant while the camera turns. */
window.flicker = ({ kind, distance, size, samples, frames }) => {
  stage.show(kind);
  const all = Array.from({ length: frames }, (_, t) =>
    pictures(size, samples, { ...CAMERA, azimuth: t * STEP, distance }),
  );
  return DRAWN.map((_, i) =>
    flicker(
      all.map(({ drawn }) => drawn[i]),
      all.map(({ truth }) => truth),
    ),
  );
};

/** Returns the variants and the truth side by side, as displayed, in the data URL of a PNG. */
window.sheet = ({ kind, distance, size, samples }) => {
  stage.show(kind);
  const { drawn, truth } = pictures(size, samples, { ...CAMERA, distance });
  const canvas = Object.assign(document.createElement('canvas'), { width: (DRAWN.length + 1) * size, height: size });
  const context = canvas.getContext('2d');
  [...drawn, truth].forEach((picture, n) => {
    const image = context.createImageData(size, size);
    for (let y = 0; y < size; y++) {
      for (let i = 0; i < 4 * size; i++) {
        const value = picture[4 * size * (size - 1 - y) + i];
        image.data[4 * size * y + i] = i % 4 === 3 ? 255 : 255 * (value / (1 + value)) ** (1 / 2.2);
      }
    }
    context.putImageData(image, n * size, 0);
  });
  return canvas.toDataURL();
};
