// A reader of docs/extension/README.md draws the same picture as the plugin of three.js, and the pixels that it lists.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { picture } from './extension_picture.js';
import { EXTENSION } from './extension_reader.js';
import { exactLevel } from './extension_texture.js';
import { PLANE, WITHOUT_K, bake, material, withTextures, write } from './plane_asset.js';
import { VIEW, difference, openPictures, skip } from './plane_page.js';
import { missing, repository, temporary } from './roughcast.js';
import { THREE_JS } from './three_engine.js';

const LIGHT = { direction: [-0.3, 1, -0.9], irradiance: 3 };

/** Largest difference of a channel of a pixel, as a share of the brightest. The measured differences are up to 2e-5. */
const BOUND = 1e-4;
/** The largest difference with exact levels of detail. SwiftShader's are off by up to 1/46. */
const LEVELS = 0.03;
/** The least difference of a reader that does one thing wrong. */
const WRONG = LEVELS;

const extension = (drawn) => drawn.material.extensions[EXTENSION];
const TURNED = { offset: [0.13, -0.4], rotation: 0.6, scale: [3, 5] };
const ANISOTROPIC = { roughnessFactor: 0.3, anisotropy: { anisotropyStrength: 0.6, anisotropyRotation: 0.7 } };

/**
 * What is drawn, by name. `model` is that of the bake, `plane` and the rest change the asset, and `wrong` changes what
 * the reader draws. `textured` names the textures of the roughened lobe as those of the base lobe: they have mips.
 */
const CASES = {
  'a metal': { wrong: (drawn) => (extension(drawn).correctionFactor = 0) },
  'a dielectric': { metalness: 0, wrong: (drawn) => (extension(drawn).correctionFactor = 0) },
  'a standard deviation': { model: 'isotropic', wrong: (drawn) => (extension(drawn).roughnessMax = [0]) },
  'the least roughness of the engine': {
    lobe: { roughnessFactor: 0.01 },
    wrong: (drawn) => (drawn.engine.leastRoughness = 0.15),
  },
  'slopes that are scaled and mirrored': {
    members: { offsetScale: [-0.5, 0.7] },
    wrong: (drawn) => (extension(drawn).offsetScale = [0.5, 0.7]),
  },
  'slopes in two channels, magnified': {
    members: { offsetChannels: 2 },
    transforms: [{ scale: [0.1, 0.1] }],
    wrong: (drawn) => (extension(drawn).offsetChannels = 3),
  },
  'a map that is minified': {
    transforms: [{ scale: [6, 6] }],
    wrong: ({ engine }) => (engine.level = (squared) => Math.round(exactLevel(squared))),
  },
  'a roughness texture': {
    lobe: { roughnessFactor: 0.8 },
    textured: ['metallicRoughnessTexture'],
    wrong: (drawn) => delete extension(drawn).baseLobe.metallicRoughnessTexture,
  },
  'an anisotropic base lobe': {
    lobe: ANISOTROPIC,
    wrong: (drawn) => (extension(drawn).baseLobe.anisotropy.anisotropyRotation *= -1),
  },
  'an anisotropic base lobe without tangents': {
    lobe: ANISOTROPIC,
    plane: { tangent: null },
    wrong: (drawn) => (extension(drawn).baseLobe.anisotropy.anisotropyRotation *= -1),
  },
  'an anisotropic base lobe without tangents, on a stretched map': {
    lobe: ANISOTROPIC,
    plane: { tangent: null },
    transforms: [{ scale: [3, 1] }],
    wrong: (drawn) => (extension(drawn).baseLobe.anisotropy.anisotropyRotation = Math.atan2(Math.tan(0.7), 3)),
  },
  'an anisotropic base lobe and no K': {
    lobe: { ...ANISOTROPIC, roughnessFactor: 0.5 },
    members: WITHOUT_K,
    wrong: (drawn) => (extension(drawn).baseLobe.anisotropy.anisotropyRotation *= -1),
  },
  'an anisotropic base lobe of the core material': {
    lobe: ANISOTROPIC,
    isCore: true,
    wrong: (drawn) => delete drawn.material.extensions.KHR_materials_anisotropy,
  },
  'an anisotropy texture': {
    lobe: ANISOTROPIC,
    textured: ['anisotropyTexture'],
    wrong: (drawn) => delete extension(drawn).baseLobe.anisotropy.anisotropyTexture,
  },
  'a transform': {
    transforms: [TURNED],
    wrong: (drawn) => (extension(drawn).offsetTexture.extensions.KHR_texture_transform.rotation *= -1),
  },
  'a transform of each texture': {
    transforms: [{ scale: [2, 2] }, TURNED],
    wrong: (drawn) => (extension(drawn).roughnessTexture.extensions = extension(drawn).offsetTexture.extensions),
  },
  'a transform without tangents': {
    transforms: [TURNED],
    plane: { tangent: null },
    wrong: (drawn) => (drawn.plane.tangent = PLANE.tangent),
  },
  'the natural frame': {
    members: { frame: 'natural' },
    transforms: [{ scale: [2, 1] }],
    wrong: (drawn) => (extension(drawn).frame = 'unit'),
  },
  'the frame of a main direction, in a node that is mirrored': {
    members: { frame: 'mainDirection', mainDirection: [0.6, 0, 0.8] },
    plane: { node: [-0.5, 1, 1] },
    wrong: (drawn) => (extension(drawn).frame = 'unit'),
  },
  'a node that is mirrored': {
    plane: { node: [-1, 1, 1] },
    wrong: (drawn) => (drawn.plane.tangent = [1, 0, 0, -1]),
  },
  'a node that is mirrored, without tangents': {
    plane: { node: [-1, 1, 1], tangent: null },
    wrong: (drawn) => (drawn.plane.tangent = PLANE.tangent),
  },
  'the back of a plane': {
    plane: { node: [-1, -1, 1] },
    wrong: (drawn) => (drawn.plane.tangent = [1, 0, 0, -1]),
  },
};

test('a reader of the page draws the picture of the plugin', { skip }, async (t) => {
  const folder = temporary(t);
  const bakes = Object.fromEntries(['anisotropic', 'isotropic'].map((model) => [model, bake(folder, model)]));
  const page = await openPictures(t, folder);
  const view = { ...VIEW, light: LIGHT };

  for (const [name, { model = 'anisotropic', plane, textured, wrong, ...change }] of Object.entries(CASES)) {
    await t.test(name, async () => {
      const baked = bakes[model];
      const lobe = textured ? withTextures(baked, change.lobe, textured) : change.lobe;
      const asset = { material: material(baked, { ...change, lobe }), plane: { ...PLANE, ...plane } };
      const url = `/baked/${model}/${write(baked, asset.material, asset.plane)}`;
      const found = await page.evaluate((options) => window.picture(options), { url, ...view });
      assert.deepEqual(page.problems, []);
      const off = (edit) => {
        const drawn = { ...structuredClone(asset), textures: baked.textures, engine: { ...THREE_JS } };
        edit(drawn);
        return difference(picture(drawn, view), found);
      };
      const [right, exact, bad] = [() => {}, ({ engine }) => (engine.level = exactLevel), wrong].map(off);
      assert.ok(right < BOUND, `off by ${right}`);
      assert.ok(exact < LEVELS, `off by ${exact} with exact levels of detail`);
      assert.ok(bad > WRONG, `a wrong reader is off by ${bad} only`);
    });
  }
});

test('the pixels that the page lists are those of its reader', { skip: missing }, (t) => {
  const page = readFileSync(path.join(repository, 'docs/extension/README.md'), 'utf8');
  const [, table] = page.match(/<!-- pixels: [^]*?-->([^]*?)<!-- pixels end -->/);
  const rows = [...table.matchAll(/^\| (\d+) \| (\d+) \| (.*) \|$/gm)];
  const { textures, ...baked } = bake(temporary(t), 'anisotropic', ['--profile', 'pyramid']);
  const { roughnessFactor } = baked.gltf.materials[0].pbrMetallicRoughness;
  const drawn = (members) => {
    const core = material(baked, { isCore: true, lobe: { roughnessFactor }, members });
    const engine = { ...THREE_JS, level: exactLevel };
    return picture({ material: core, plane: PLANE, textures, engine }, { ...VIEW, light: LIGHT });
  };
  const [right, withoutK] = [drawn({}), drawn({ correctionFactor: 0 })];
  assert.equal(rows.length, 5);
  for (const [, column, row, printed] of rows) {
    const pixel = Number(row) * VIEW.size + Number(column);
    const values = [...right[pixel], withoutK[pixel][0]].map((value) => value.toFixed(4));
    assert.equal(values.join(' | '), printed, `column ${column}, row ${row}`);
  }
  const [, brightest] = page.match(/The brightest pixel has ([\d.]+) in red\./);
  assert.equal(Math.max(...right.flatMap((pixel) => pixel ?? [])).toFixed(2), brightest);
});
