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
const stage = new Stage(renderer);

const read = (target) => {
  const { width, height } = target;
  const pixels = new Float32Array(4 * width * height);
  renderer.readRenderTargetPixels(target, 0, 0, width, height, pixels);
  return pixels;
};

/** Draws variants from one camera. */
function draw(names, size, view) {
  const target = new THREE.WebGLRenderTarget(size, size, { type: THREE.FloatType });
  stage.resize(size, size);
  stage.look(view);
  const drawn = names.map((name) => {
    stage.draw(name, target);
    return read(target);
  });
  target.dispose();
  return drawn;
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
window.load = async (urls) => {
  await stage.load(urls);
  stage.light(LIGHT);
};

/** Returns the errors of all variants, or of `names`, at a distance: [[relative L1, SSIM], ...]. */
window.errors = ({ kind, distance, size, samples, names }) => {
  stage.show(kind);
  const { drawn, truth } = pictures(size, samples, { ...CAMERA, distance }, names);
  return drawn.map((picture) => [relativeL1(picture, truth), ssim(picture, truth, size)]);
};

/** Returns the mean relative L1 of each variant over lights from `lights`, in degrees. */
window.underLights = ({ kind, distance, size, samples, lights }) => {
  stage.show(kind);
  const errors = lights.map((from) => {
    stage.light({ ...LIGHT, ...from });
    const { drawn, truth } = pictures(size, samples, { ...CAMERA, distance });
    return drawn.map((picture) => relativeL1(picture, truth));
  });
  stage.light(LIGHT);
  return DRAWN.map((_, i) => errors.reduce((sum, of) => sum + of[i], 0) / lights.length);
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
window.ready = true;
