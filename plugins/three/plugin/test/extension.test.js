import assert from 'node:assert/strict';
import test from 'node:test';
import { EXTENSION, readExtension } from '../src/index.js';
import { withBaseLobe } from '../src/extension.js';

const definition = () => ({
  formatVersion: 2,
  offsetTexture: { index: 3, texCoord: 1 },
  offsetChannels: 3,
  offsetScale: [0.5, -0.25],
  roughnessModel: 'covarianceFactor',
  roughnessTexture: { index: 4 },
  roughnessMin: [0, -0.1, 0],
  roughnessMax: [0.2, 0.1, 0.3],
  correctionFactor: 0.8,
  frame: 'unit',
});

test('reads what the tool writes', () => {
  const { offset, roughness, ...rest } = readExtension(definition());
  assert.deepEqual(offset, { texture: { index: 3, texCoord: 1 }, channels: 3, scale: [0.5, -0.25] });
  assert.deepEqual(roughness, {
    model: 'covarianceFactor',
    texture: { index: 4 },
    min: [0, -0.1, 0],
    max: [0.2, 0.1, 0.3],
  });
  assert.deepEqual(rest, { correctionFactor: 0.8, frame: 'unit', mainDirection: null, baseLobe: null });
});

test('reads pyramids without roughness and with lambda_1 in one channel', () => {
  const { roughnessModel, roughnessTexture, roughnessMin, roughnessMax, ...smooth } = definition();
  assert.equal(readExtension(smooth).roughness, null);
  const lambda1 = { ...definition(), roughnessModel: 'standardDeviation', roughnessMin: [0], roughnessMax: [0.4] };
  assert.deepEqual(readExtension(lambda1).roughness.max, [0.4]);
});

test('reads the main direction with its frame only', () => {
  const main = { ...definition(), frame: 'mainDirection', mainDirection: [0, 0, 1] };
  assert.deepEqual(readExtension(main).mainDirection, [0, 0, 1]);
  assert.equal(readExtension({ ...definition(), frame: 'natural' }).mainDirection, null);
});

test('names each wrong property', () => {
  const wrong = {
    formatVersion: [undefined, 0, 1, 3, '2'],
    offsetTexture: [undefined, null, 3, {}, { index: -1 }, { index: 0.5 }, { index: 0, texCoord: -1 }],
    offsetChannels: [undefined, 1, 4, '3'],
    offsetScale: [undefined, [0], [0, 0, 0], [0, NaN], ['0', 0], [1, Infinity], { length: 2 }],
    roughnessModel: [undefined, 'beckmann', 'toString', 1],
    roughnessTexture: [undefined, { index: '4' }],
    roughnessMin: [undefined, [0]],
    roughnessMax: [[1, 1, null]],
    correctionFactor: [undefined, -1, NaN, '1'],
    frame: [undefined, 'world', null],
    mainDirection: [[0, 0, 1], null],
    baseLobe: [null, 1, []],
  };
  for (const [name, values] of Object.entries(wrong)) {
    for (const value of values) {
      assert.throws(() => readExtension({ ...definition(), [name]: value }), {
        name: 'TypeError',
        message: new RegExp(`^${EXTENSION}: ${name}: expected .*, found `),
      });
    }
  }
  assert.throws(() => readExtension({ ...definition(), frame: 'mainDirection' }), /mainDirection: expected 3/);
  for (const direction of [[0, 1], [0, 0, '1'], null]) {
    const main = { ...definition(), frame: 'mainDirection', mainDirection: direction };
    assert.throws(() => readExtension(main), /mainDirection: expected 3/);
  }
  for (const nothing of [null, undefined, 1, 'x', []])
    assert.throws(() => readExtension(nothing), /expected an object/);
});

test('uses the direction of a main direction of any length', () => {
  const main = { ...definition(), frame: 'mainDirection', mainDirection: [0, 0, 2] };
  assert.deepEqual(readExtension(main).mainDirection, [0, 0, 2]);
});

test('refuses a part of what belongs to a roughness model', () => {
  const { roughnessModel, roughnessTexture, roughnessMin, roughnessMax, ...smooth } = definition();
  for (const [name, value] of Object.entries({ roughnessTexture, roughnessMin, roughnessMax })) {
    for (const part of [value, null])
      assert.throws(() => readExtension({ ...smooth, [name]: part }), /roughnessModel: expected .*, found undefined/);
  }
});

test('names each wrong property of the base lobe', () => {
  const wrong = {
    roughnessFactor: [null, '1', NaN, [1]],
    metallicRoughnessTexture: [null, 3, {}, { index: -1 }, { index: 0, texCoord: 0.5 }],
    anisotropy: [null, 1, []],
  };
  const wrongAnisotropy = {
    anisotropyStrength: [null, '1'],
    anisotropyRotation: [null, Infinity],
    anisotropyTexture: [null, {}, { index: '0' }],
  };
  const assertNamed = (name, value, baseLobe) =>
    assert.throws(() => readExtension({ ...definition(), baseLobe }), {
      name: 'TypeError',
      message: new RegExp(`^${EXTENSION}: ${name}: expected .*, found `),
    });
  for (const [name, values] of Object.entries(wrong))
    for (const value of values) assertNamed(name, value, { [name]: value });
  for (const [name, values] of Object.entries(wrongAnisotropy))
    for (const value of values) assertNamed(name, value, { anisotropy: { [name]: value } });
  const whole = {
    roughnessFactor: 0.3,
    metallicRoughnessTexture: { index: 1, texCoord: 1 },
    anisotropy: { anisotropyStrength: 0.5, anisotropyRotation: -1, anisotropyTexture: { index: 2 } },
  };
  for (const baseLobe of [whole, {}, { anisotropy: {} }, { unknown: 1 }])
    assert.deepEqual(readExtension({ ...definition(), baseLobe }).baseLobe, baseLobe);
});

test('replaces the whole roughened lobe by the base lobe', () => {
  const roughened = {
    name: 'brass',
    pbrMetallicRoughness: { metallicFactor: 1, roughnessFactor: 1, metallicRoughnessTexture: { index: 5 } },
    extensions: { KHR_materials_anisotropy: { anisotropyStrength: 1 }, KHR_materials_ior: {} },
  };
  assert.deepEqual(withBaseLobe(roughened, { roughnessFactor: 0.3 }), {
    name: 'brass',
    pbrMetallicRoughness: { metallicFactor: 1, roughnessFactor: 0.3 },
    extensions: { KHR_materials_ior: {} },
  });
  const anisotropy = { anisotropyStrength: 0.5 };
  const metallicRoughnessTexture = { index: 1 };
  assert.deepEqual(withBaseLobe({}, { metallicRoughnessTexture, anisotropy }), {
    pbrMetallicRoughness: { metallicRoughnessTexture },
    extensions: { KHR_materials_anisotropy: anisotropy },
  });
});
