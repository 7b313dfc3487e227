import assert from 'node:assert/strict';
import test from 'node:test';
import { MeshBasicMaterial, MeshPhysicalMaterial, MeshStandardMaterial, ShaderLib, Texture } from 'three';
import { applyPyramid, applyReflections } from '../src/index.js';

const pyramid = (changes = {}) => ({
  offset: { map: new Texture(), channels: 3, scale: [0.5, -0.25] },
  roughness: { model: 'covarianceFactor', map: new Texture(), min: [0, 0, 0], max: [1, 1, 1] },
  correctionFactor: 0.7,
  frame: 'unit',
  mainDirection: null,
  ...changes,
});

/** Returns what three.js passes to onBeforeCompile. */
const program = () => {
  const { vertexShader, fragmentShader } = ShaderLib.physical;
  return { uniforms: {}, vertexShader, fragmentShader };
};

const compiled = (material) => {
  const made = program();
  material.onBeforeCompile(made);
  return made;
};

test('puts the maps into their slots and the ranges into uniforms', () => {
  const data = pyramid();
  const material = applyPyramid(new MeshStandardMaterial(), data);
  assert.equal(material.normalMap, data.offset.map);
  assert.equal(material.bumpMap, data.roughness.map);
  const { uniforms, fragmentShader } = compiled(material);
  assert.equal(uniforms.roughcastCorrection.value, 0.7);
  assert.deepEqual(uniforms.roughcastOffsetScale.value.toArray(), [0.5, -0.25]);
  assert.match(fragmentShader, /define ROUGHCAST_FACTOR/);
  assert.doesNotMatch(fragmentShader, /define ROUGHCAST_REBUILT_Z/);
  assert.doesNotMatch(fragmentShader, /#include <normal_fragment_maps>/);
});

test('patches clones and clones of clones alike', () => {
  const material = applyPyramid(new MeshPhysicalMaterial({ anisotropy: 0.5 }), pyramid());
  const first = material.clone();
  first.normalScale.y = -1;
  const second = first.clone();
  assert.equal(second.normalScale.y, -1);
  for (const copy of [first, second]) {
    assert.deepEqual(compiled(copy).fragmentShader, compiled(material).fragmentShader);
    assert.equal(copy.customProgramCacheKey(), material.customProgramCacheKey());
  }
});

test('compiles a program for each variant', () => {
  const lambda1 = { model: 'standardDeviation', map: new Texture(), min: [0], max: [1] };
  const variants = [
    pyramid(),
    pyramid({ roughness: lambda1 }),
    pyramid({ roughness: null }),
    pyramid({ frame: 'natural' }),
    pyramid({ offset: { ...pyramid().offset, channels: 2 } }),
  ];
  const keys = variants.map((variant) => applyPyramid(new MeshStandardMaterial(), variant).customProgramCacheKey());
  assert.equal(new Set([...keys, new MeshStandardMaterial().customProgramCacheKey()]).size, 6);
});

test('rebuilds z where it is not stored', () => {
  const material = applyPyramid(new MeshStandardMaterial(), pyramid({ offset: { ...pyramid().offset, channels: 2 } }));
  assert.match(compiled(material).fragmentShader, /define ROUGHCAST_REBUILT_Z/);
});

test('keeps patches of others', () => {
  const material = new MeshStandardMaterial();
  material.onBeforeCompile = (made) => (made.fragmentShader = `// theirs\n${made.fragmentShader}`);
  applyPyramid(material, pyramid());
  assert.match(compiled(material).fragmentShader, /\/\/ theirs/);
  assert.match(compiled(material.clone()).fragmentShader, /\/\/ theirs/);
});

test('patches reflections without a pyramid', () => {
  const material = applyReflections(new MeshPhysicalMaterial({ anisotropy: 1 }));
  for (const shown of [material, material.clone()]) {
    assert.match(compiled(shown).fragmentShader, /roughcastRadiance/);
    assert.doesNotMatch(compiled(shown).fragmentShader, /roughcastOffset/);
  }
  assert.throws(() => applyReflections(new MeshBasicMaterial()), /found MeshBasicMaterial/);
});

test('refuses what cannot be patched', () => {
  assert.throws(() => applyPyramid(new MeshBasicMaterial(), pyramid()), /found MeshBasicMaterial/);
  const material = applyPyramid(new MeshStandardMaterial(), pyramid());
  assert.throws(() => material.onBeforeCompile({ ...program(), fragmentShader: '' }), /this version of three.js/);
});
