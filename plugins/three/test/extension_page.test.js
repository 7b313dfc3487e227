// docs/extension/README.md against what the tool writes, and the numbers of its worked example.
import assert from 'node:assert/strict';
import { cpSync, readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import * as reader from './extension_reader.js';
import { halfFloats } from './half_floats.js';
import { missing, repository, roughcast, temporary } from './roughcast.js';

const page = readFileSync(path.join(repository, 'docs/extension/README.md'), 'utf8');
const [overview, example] = [...page.matchAll(/```json\n([^]*?)```/g)].map(([, text]) => JSON.parse(text));

/** The surface of the worked example. */
const SURFACE = { n: [0, 0, 1], t: [1, 0, 0], b: [0, 1, 0], lengths: [1, 1] };

/** Asserts that `found` is `printed`, which has four digits. */
function assertPrinted(found, printed, name) {
  const digits = (value) => (Array.isArray(value) ? value.map(digits) : Number(value.toFixed(4)) + 0);
  assert.deepEqual(digits(found), printed, name);
}

test('the worked example of the page is right', () => {
  const extension = overview.materials[0].extensions[reader.EXTENSION];
  const { roughnessFactor } = overview.materials[0].pbrMetallicRoughness;
  const slopes = reader.slopes(extension, example.offsetTexel);
  assertPrinted(slopes, example.slopes, 'slopes');
  assertPrinted(reader.normal(reader.frame(extension, SURFACE), slopes), example.normal, 'normal');
  const k = reader.covariance(extension, example.roughnessTexel);
  assertPrinted(k, example.K, 'K');
  const [[d1, d2], [zero, d3]] = example.D;
  assertPrinted([d1 * d1 + d2 * d2, d2 * d3 + zero, d3 * d3], example.K, 'D');
  const base = reader.baseLobe(roughnessFactor);
  assertPrinted(base, example.baseLobe, 'base lobe');
  const lobe = reader.roughened(extension, base, k);
  assertPrinted(lobe, example.roughenedLobe, 'roughened lobe');
  const found = reader.parameters(lobe, base[0]);
  for (const name of ['eigenvalues', 'axis', 'alphas', 'roughness', 'strength']) {
    assertPrinted(found[name], example[name], name);
  }
  assertPrinted(reader.parts(extension, base, k, found.axis).shares, example.shares, 'P_t and P_b');
});

/** The surface of the plane in fixtures/real after it is stretched: p_u = 3 T and p_v = -B / 2, in units per repeat. */
const STRETCH = [3, 1, 0.5];
const PLANE = { n: [0, 1, 0], t: [1, 0, 0], b: [0, 0, -1], lengths: [STRETCH[0], STRETCH[2]] };

/** Bakes the stretched plane. Returns its extension, its base roughness, and the levels of each texture. */
function bake(folder, options) {
  const [source, output] = ['source', 'baked'].map((name) => path.join(folder, name));
  cpSync(path.join(repository, 'fixtures/real'), source, { recursive: true });
  const file = path.join(source, 'gravel.bin');
  const bytes = readFileSync(file);
  // The positions come first: four vectors of floats.
  for (let i = 0; i < 12; i++) bytes.writeFloatLE(bytes.readFloatLE(4 * i) * STRETCH[i % 3], 4 * i);
  writeFileSync(file, bytes);
  const form = ['--profile', 'both', '--target', 'float', '--gltf', 'dual', '--quiet'];
  roughcast('bake', source, '-o', output, ...form, ...options);
  const { materials, textures, images } = JSON.parse(readFileSync(path.join(output, 'gravel.gltf'), 'utf8'));
  const { normalTexture, pbrMetallicRoughness, extensions } = materials[0];
  const fileOf = (info) => path.join(output, decodeURIComponent(images[textures[info.index].source].uri));
  const levels = (info) => info && halfFloats(fileOf(info)).map(({ texels }) => texels);
  return {
    extension: extensions[reader.EXTENSION],
    roughness: extensions[reader.EXTENSION].baseLobe.roughnessFactor,
    offset: levels(extensions[reader.EXTENSION].offsetTexture),
    lost: levels(extensions[reader.EXTENSION].roughnessTexture),
    core: {
      normal: levels(normalTexture),
      roughness: levels(pbrMetallicRoughness.metallicRoughnessTexture),
      anisotropy: levels(extensions.KHR_materials_anisotropy?.anisotropyTexture),
    },
  };
}

/** Returns a lobe in the axes (T, B) of the plane as a matrix of the surface: [tt, tb, bb]. */
function alongSurface([uu, uv, vv], [e1, e2]) {
  const along = (axis) => [PLANE.t, PLANE.b].map((direction) => direction.reduce((s, d, i) => s + d * axis[i], 0));
  const [[a, b], [c, d]] = [along(e1), along(e2)];
  const entry = (x, y, z, w) => uu * x * y + uv * (x * w + z * y) + vv * z * w;
  return [entry(a, a, c, c), entry(a, b, c, d), entry(b, b, d, d)];
}

/** Returns the largest differences between pyramid and core textures, over all texels of all levels. */
function differences({ extension, roughness, offset, lost, core }) {
  const worst = { normal: 0, lobe: 0 };
  const frame = reader.frame(extension, PLANE);
  const base = reader.baseLobe(roughness);
  for (const [level, texels] of offset.entries()) {
    for (const [i, texel] of texels.entries()) {
      const [x, y, z] = core.normal[level][i].map((value) => 2 * value - 1);
      const shown = PLANE.n.map((n, c) => x * PLANE.t[c] + y * PLANE.b[c] + z * n);
      const found = reader.normal(frame, reader.slopes(extension, texel));
      worst.normal = Math.max(worst.normal, ...found.map((value, c) => Math.abs(value - shown[c])));

      const k = reader.scaledCovariance(frame, reader.covariance(extension, lost[level][i]));
      const { roughness: r, strength, axis } = reader.parameters(reader.roughened(extension, base, k), base[0]);
      const drawn = alongSurface(reader.baseLobe(r, strength, axis), [frame.e1, frame.e2]);
      const [u, v, s] = core.anisotropy?.[level][i] ?? [1, 0.5, 0];
      const expected = reader.baseLobe(core.roughness[level][i][1], s, [2 * u - 1, 2 * v - 1]);
      const difference = Math.max(...drawn.map((value, c) => Math.abs(value - expected[c])));
      worst.lobe = Math.max(worst.lobe, difference / (expected[0] + expected[2]));
    }
  }
  return worst;
}

const CASES = {
  unit: ['--model', 'anisotropic'],
  natural: ['--model', 'anisotropic', '--frame', 'natural'],
  mainDirection: ['--model', 'anisotropic', '--frame', 'main-direction', '--main-direction', '1,0.2,0.5'],
  standardDeviation: ['--model', 'isotropic'],
};

for (const [name, options] of Object.entries(CASES)) {
  test(`a reader of the page finds the lobes of the core textures: ${name}`, { skip: missing }, (t) => {
    const baked = bake(temporary(t), options);
    assert.ok([baked.extension.frame, baked.extension.roughnessModel].includes(name));
    const { normal, lobe } = differences(baked);
    assert.equal(baked.offset.length, 8);
    assert.ok(normal < 2e-3, `normals differ by ${normal}`);
    assert.ok(lobe < 1e-2, `lobes differ by ${lobe}`);
  });
}
