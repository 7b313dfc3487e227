// A reader of docs/extension/README.md draws the same picture under an environment as the plugin of three.js.
import assert from 'node:assert/strict';
import test from 'node:test';
import { METHOD, picture } from './extension_environment.js';
import { EXTENSION, lookUps } from './extension_reader.js';
import { PLANE, WITHOUT_K, bake, material, write } from './plane_asset.js';
import { VIEW, difference, openPictures, skip } from './plane_page.js';
import { temporary } from './roughcast.js';
import { THREE_JS } from './three_engine.js';

/** Largest difference of a channel of a pixel, as a share of the brightest. The measured differences are up to 8e-5. */
const BOUND = 2e-4;
/** The least difference of a reader that does one thing wrong. */
const WRONG_BOUND = 2e-3;
/** The largest difference of one look-up with the roughness of equal determinant. */
const ONE = 0.3;

const extension = (drawn) => drawn.material.extensions[EXTENSION];
const ANISOTROPIC = { roughnessFactor: 0.3, anisotropy: { anisotropyStrength: 0.6, anisotropyRotation: 0.7 } };

/** What a reader does wrong, by name. */
const WRONG = {
  'the covariance c K': (drawn) => (drawn.method.spread = 1),
  'no blur': (drawn) => (drawn.method.blur = 0),
  'fewer look-ups': (drawn) => (drawn.method.count = 14),
  'no K': (drawn) => (extension(drawn).correctionFactor = 0),
  'the rotation of the base lobe': (drawn) => (extension(drawn).baseLobe.anisotropy.anisotropyRotation *= -1),
};
/** Wrongs of all cases with K. */
const OF_K = ['the covariance c K', 'no blur', 'fewer look-ups', 'no K'];

/** What is drawn, by name, as in extension_picture.test.js. `wrong` names what a reader does wrong, one at a time. */
const CASES = {
  'a metal': { wrong: OF_K },
  'a dielectric': { metalness: 0, wrong: OF_K },
  'a standard deviation': { model: 'isotropic', wrong: ['no K'] },
  'a standard deviation on an anisotropic base lobe': {
    model: 'isotropic',
    lobe: ANISOTROPIC,
    wrong: [...OF_K, 'the rotation of the base lobe'],
  },
  'an anisotropic base lobe': { lobe: ANISOTROPIC, wrong: [...OF_K, 'the rotation of the base lobe'] },
  'an anisotropic base lobe and no K': {
    lobe: { ...ANISOTROPIC, roughnessFactor: 0.5 },
    members: WITHOUT_K,
    wrong: ['the covariance c K', 'fewer look-ups', 'the rotation of the base lobe'],
  },
  'a plane without tangents': { plane: { tangent: null }, wrong: OF_K },
  'a node that is mirrored, without tangents': {
    plane: { node: [-1, 1, 1], tangent: null },
    wrong: OF_K,
  },
  'the natural frame': { members: { frame: 'natural' }, transforms: [{ scale: [2, 1] }], wrong: OF_K },
  'the frame of a main direction, in a node that is mirrored': {
    members: { frame: 'mainDirection', mainDirection: [0.6, 0, 0.8] },
    plane: { node: [-0.5, 1, 1] },
    wrong: OF_K,
  },
  'a node that is mirrored': { plane: { node: [-1, 1, 1] }, wrong: OF_K },
  'the back of a plane': { plane: { node: [-1, -1, 1] }, wrong: OF_K },
  'the back of a plane, in the frame of a main direction': {
    members: { frame: 'mainDirection', mainDirection: [0.6, 0, 0.8] },
    plane: { node: [-1, -1, 1] },
    wrong: OF_K,
  },
};

test('a reader of the page draws the picture of the plugin under an environment', { skip }, async (t) => {
  const folder = temporary(t);
  const bakes = Object.fromEntries(['anisotropic', 'isotropic'].map((model) => [model, bake(folder, model)]));
  const page = await openPictures(t, folder);
  const lookUp = async (places) => {
    const found = await page.evaluate((given) => window.lookUp(given), places.flat());
    return places.map((_, i) => found.slice(4 * i, 4 * i + 3));
  };

  for (const [name, { model = 'anisotropic', plane, wrong, ...change }] of Object.entries(CASES)) {
    await t.test(name, async () => {
      const baked = bakes[model];
      const asset = { material: material(baked, change), plane: { ...PLANE, ...plane } };
      const url = `/baked/${model}/${write(baked, asset.material, asset.plane)}`;
      const found = await page.evaluate((options) => window.picture(options), { url, ...VIEW });
      assert.deepEqual(page.problems, []);
      const off = async (edit) => {
        const drawn = { ...structuredClone(asset), textures: baked.textures, engine: { ...THREE_JS } };
        drawn.method = { ...METHOD };
        edit(drawn);
        return difference(await picture(drawn, VIEW, lookUp), found);
      };
      const right = await off(() => {});
      assert.ok(right < BOUND, `off by ${right}`);
      for (const each of wrong) {
        const bad = await off(WRONG[each]);
        assert.ok(bad > WRONG_BOUND, `a reader with ${each} is off by ${bad} only`);
      }
      const one = await off((drawn) => (drawn.method.count = 1));
      assert.ok(one < ONE, `one look-up is off by ${one}`);
    });
  }
});

test('the slopes of look-ups have the covariance 1.3 c K', () => {
  const [base, k] = [0.3 ** 4, [0.05, 0.02]];
  const lit = {
    normal: [0, 0, 1],
    axes: [
      [1, 0, 0],
      [0, 1, 0],
    ],
    alphas: k.map((variance) => Math.sqrt(base + 2 * variance)),
    baseRoughness: 0.3,
  };
  const slopes = (method) => lookUps(lit, method).normals.map(([x, y, z]) => [x / z, y / z]);
  const variances = (all) => [0, 1].map((i) => all.reduce((sum, slope) => sum + slope[i] ** 2, 0) / all.length);
  const many = variances(slopes({ count: 4096, blur: 0, spread: 1.3 }));
  for (const [i, variance] of many.entries()) assert.ok(Math.abs(variance / k[i] - 1.3) < 0.01, `${many}`);
  // The part that is left to blur is missing in the slopes, and 16 slopes are few.
  const few = variances(slopes(METHOD)).map((variance, i) => variance / (k[i] - k[1] / 4));
  for (const [i, wanted] of [1.04, 1.45].entries()) assert.ok(Math.abs(few[i] - wanted) < 0.01, `${few}`);
});
