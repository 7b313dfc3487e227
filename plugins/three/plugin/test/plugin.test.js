import assert from 'node:assert/strict';
import test from 'node:test';
import { MeshBasicMaterial, MeshStandardMaterial, Texture } from 'three';
import { EXTENSION, RoughcastPlugin } from '../src/index.js';

const definition = {
  formatVersion: 2,
  offsetTexture: { index: 0 },
  offsetChannels: 3,
  offsetScale: [1, 1],
  correctionFactor: 1,
  frame: 'unit',
};

/** Returns the part of GLTFParser that the plugin calls. */
const parser = (extensions, { material = new MeshStandardMaterial(), texture = new Texture() } = {}) => ({
  json: { materials: [{ extensions }] },
  loadMaterial: async () => material,
  assignTexture: async () => texture,
  getDependency: async () => texture,
});

const load = async (t, extensions, given, options) => {
  const warn = t.mock.method(console, 'warn', () => {});
  const material = await new RoughcastPlugin(parser(extensions, given), options).loadMaterial(0);
  return { material, warnings: warn.mock.calls.map((call) => call.arguments[0]) };
};

test('leaves a material without the extension to the loader', async (t) => {
  assert.equal((await load(t, undefined)).material, null);
  assert.equal((await load(t, {})).material, null);
  assert.equal(new RoughcastPlugin(parser({})).name, EXTENSION);
});

test('patches a material with the extension', async (t) => {
  const { material, warnings } = await load(t, { [EXTENSION]: definition });
  assert.ok(material.normalMap);
  assert.deepEqual(warnings, []);
});

test('adds K to the base lobe, not to the roughened one', async (t) => {
  const json = { materials: [{ pbrMetallicRoughness: { roughnessFactor: 1 }, extensions: {} }] };
  const [roughened] = json.materials;
  const seen = [];
  const given = {
    ...parser(),
    json,
    loadMaterial: async (index) => {
      seen.push(json.materials[index].pbrMetallicRoughness.roughnessFactor);
      return new MeshStandardMaterial();
    },
  };
  roughened.extensions[EXTENSION] = { ...definition, baseLobe: { roughnessFactor: 0.3 } };
  await new RoughcastPlugin(given).loadMaterial(0);
  json.materials[0] = roughened;
  t.mock.method(console, 'warn', () => {});
  await new RoughcastPlugin({ ...given, assignTexture: async () => null }).loadMaterial(0);
  assert.deepEqual(seen, [0.3, 1], 'without its textures only the roughened lobe is left');
});

test('ignores the whole extension if a texture of the base lobe cannot be loaded', async (t) => {
  const warn = t.mock.method(console, 'warn', () => {});
  const lobes = [{ metallicRoughnessTexture: { index: 7 } }, { anisotropy: { anisotropyTexture: { index: 7 } } }];
  for (const baseLobe of lobes) {
    for (const fail of [async () => null, async () => Promise.reject(new Error('none'))]) {
      const given = parser({ [EXTENSION]: { ...definition, baseLobe } });
      given.getDependency = (type, index) => (index === 7 ? fail() : new Texture());
      const [core] = given.json.materials;
      const material = await new RoughcastPlugin(given).loadMaterial(0);
      assert.equal(material.normalMap, null);
      assert.equal(given.json.materials[0], core, 'the core material keeps its lobe');
      assert.match(warn.mock.calls.at(-1).arguments[0], /a texture cannot be loaded/);
    }
  }
});

test('warns of an extension that cannot be used and shows the material without it', async (t) => {
  const broken = await load(t, { [EXTENSION]: { ...definition, frame: 'world' } });
  assert.equal(broken.material.normalMap, null);
  assert.match(broken.warnings[0], /materials\[0\].*frame/);
  const old = await load(t, { [EXTENSION]: { ...definition, formatVersion: 1 } });
  assert.equal(old.material.normalMap, null);
  assert.match(old.warnings[0], /formatVersion: expected 2 .*, found 1/);
  const untextured = await load(t, { [EXTENSION]: definition }, { texture: null });
  assert.equal(untextured.material.normalMap, null);
  assert.match(untextured.warnings[0], /cannot be loaded/);
  const throwing = { ...parser({ [EXTENSION]: definition }), assignTexture: () => assert.fail('no such texture') };
  assert.equal((await new RoughcastPlugin(throwing).loadMaterial(0)).normalMap, null);
  const unlit = await load(t, { [EXTENSION]: definition }, { material: new MeshBasicMaterial() });
  assert.match(unlit.warnings[0], /is not lit/);
});

test('applies reflections to anisotropic materials when the option is set', async (t) => {
  const anisotropic = { KHR_materials_anisotropy: {} };
  assert.equal((await load(t, anisotropic)).material, null);
  const { material } = await load(t, anisotropic, {}, { reflections: true });
  assert.match(material.clone().customProgramCacheKey(), /reflections/);
  assert.equal((await load(t, {}, {}, { reflections: true })).material, null);
  const unlit = new MeshBasicMaterial();
  assert.equal((await load(t, anisotropic, { material: unlit }, { reflections: true })).material, unlit);
});
