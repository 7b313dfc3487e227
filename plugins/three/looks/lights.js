// Runs in the browser: draws variants and the truth under an environment and under many lights, and measures errors.
//
// Light adds up, so that one picture of the environment and one of each light give the picture of every pair.
import { switches } from '/page/debug.js';
import { relativeL1 } from '/looks/errors.js';
import { pictureOf, read, stage } from '/looks/pictures.js';

/** Distance of the camera in units. The subject then fills the picture. */
const DISTANCE = { plane: 4, sphere: 4.5 };
const CAMERA = { azimuth: 0, elevation: 35 };
const INTENSITY = 3;
/** The truth is drawn this many times larger along each axis, and averaged: large pictures are fast per sample. */
const FINER = 12;

/**
 * A view: `kind` of subject, `size` of the picture in pixels, `samples` per pixel of the truth (a multiple of 144),
 * `lights` in degrees, and `level`: a pixel at the centre is 2^level texels wide.
 *
 * @typedef {{ kind: 'plane' | 'sphere', level: number, size: number, samples: number, lights: object[] }} View
 */

/** Shows the subject with as many repeats of the maps as the level of the view asks for. */
function prepare({ kind, level, size }) {
  const nearest = DISTANCE[kind] - (kind === 'sphere' ? 1 : 0);
  const pixel = (2 * nearest * Math.tan((15 * Math.PI) / 180)) / size;
  const around = kind === 'sphere' ? 2 * Math.PI : 4;
  stage.show(kind, ((2 ** level / pixel) * around) / stage.texels);
  stage.resize(size, size);
  stage.look({ ...CAMERA, distance: DISTANCE[kind] });
}

/** Calls `draw` under the environment alone, and then under each light alone. */
function under(lights, draw) {
  stage.environment('room');
  stage.light({ azimuth: 0, elevation: 90, intensity: 0 });
  const environment = draw();
  stage.environment('none');
  return [environment, ...lights.map((from) => draw(stage.light({ ...from, intensity: INTENSITY })))];
}

/** Draws the truth of a view. Returns its pictures as bytes in base 64: RGBA in floats, the environment first. */
window.truths = (view) => {
  prepare(view);
  const { size } = view;
  const draws = view.samples / FINER ** 2;
  switches.finer.value = FINER;
  const pictures = under(view.lights, () => {
    stage.accumulator.reset(FINER * size, FINER * size);
    stage.accumulate(draws);
    return reduced(read(stage.accumulator.target), size).map((value) => value / draws);
  });
  switches.finer.value = 1;
  return new Uint8Array(Float32Array.from(pictures.flatMap((picture) => [...picture])).buffer).toBase64();
};

/** Returns the means over blocks of pixels, as a picture of `size` pixels. */
function reduced(large, size) {
  const small = new Float32Array(4 * size * size);
  const row = 4 * FINER * size;
  for (let i = 0; i < large.length; i++) {
    const x = Math.floor((i % row) / 4 / FINER);
    const y = Math.floor(i / row / FINER);
    small[4 * (size * y + x) + (i % 4)] += large[i] / FINER ** 2;
  }
  return small;
}

/**
 * Returns the errors of variants against the truth at a URL, by name of the variant: the mean over the lights of
 * `both`, each light with the environment, then `suns`, all lights without it, and `environment` without lights.
 */
window.gains = async ({ view, names, truth }) => {
  const all = new Float32Array(await (await fetch(truth)).arrayBuffer());
  const length = 4 * view.size ** 2;
  const truths = Array.from({ length: all.length / length }, (_, i) => all.subarray(i * length, (i + 1) * length));
  prepare(view);
  return Object.fromEntries(
    names.map((name) => [
      name,
      errors(
        under(view.lights, () => pictureOf(name, view.size)),
        truths,
      ),
    ]),
  );
};

/** Returns the errors of pictures, the first of which is that of the environment. */
function errors(pictures, truths) {
  // Edges of the subject, which alias, are black in all pictures.
  for (let i = 0; i < truths[0].length; i += 4) {
    if (truths[0][i + 3] < 0.999) [...pictures, ...truths].forEach((picture) => picture.fill(0, i, i + 3));
  }
  const [[environment, ...suns], [trueEnvironment, ...trueSuns]] = [pictures, truths];
  const sum = (a, b) => a.map((value, i) => value + b[i]);
  const both = suns.map((sun, i) => relativeL1(sum(sun, environment), sum(trueSuns[i], trueEnvironment)));
  return {
    both: both.reduce((total, error) => total + error, 0) / both.length,
    suns: relativeL1(joined(suns), joined(trueSuns)),
    environment: relativeL1(environment, trueEnvironment),
  };
}

/** Returns pictures one below the other. */
function joined(pictures) {
  const all = new Float32Array(pictures.length * pictures[0].length);
  pictures.forEach((picture, i) => all.set(picture, i * picture.length));
  return all;
}
