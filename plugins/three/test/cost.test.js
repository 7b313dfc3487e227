import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { missing } from '../browser.js';
import { costs } from '../looks/run.js';
import { count, forSpirv } from '../looks/spirv.js';
import { example, repository } from './roughcast.js';

/** Makes a module of instructions [opcode, ...operands]. */
const spirv = (...instructions) =>
  Uint32Array.from([
    0x07230203,
    0x10000,
    0,
    99,
    0,
    ...instructions.flatMap(([op, ...rest]) => [((rest.length + 1) << 16) | op, ...rest]),
  ]);

test('counts a function at each call', () => {
  const [fetch, add, load] = [
    [87, 1, 30, 2, 3],
    [129, 1, 31, 2, 3],
    [61, 1, 32, 2],
  ];
  const helper = [[54, 1, 20, 0, 2], fetch, add, [56]];
  const unused = [[54, 1, 21, 0, 2], fetch, [56]];
  const main = [[54, 1, 10, 0, 2], add, load, [57, 1, 40, 20], [57, 1, 41, 20], [56]];
  assert.deepEqual(count(spirv([15, 4, 10, 0], ...helper, ...unused, ...main)), { operations: 3, fetches: 2 });
});

test('counts a loop as often as it runs', () => {
  const [fetch, add] = [
    [87, 1, 30, 2, 3],
    [129, 1, 31, 2, 3],
  ];
  const helper = [[54, 1, 20, 0, 2], add, [56]];
  const loop = (end, bound) => [
    [246, end, 99, 0],
    [177, 1, 32, 33, bound],
    [177, 1, 34, 33, 7],
    fetch,
    [57, 1, 40, 20],
    [248, end],
  ];
  const endless = [[246, 52, 99, 0], fetch, add, [248, 52]];
  const main = [[54, 1, 10, 0, 2], ...loop(50, 7), add, ...loop(51, 8), ...endless, [56]];
  // 7 is the constant 4. The bound of the second loop is no constant, and the last loop has no comparison.
  const module = spirv([15, 4, 10, 0], [43, 1, 7, 4], ...helper, ...main);
  assert.deepEqual(count(module), { operations: 4 * 3 + 1 + 3 + 1, fetches: 4 + 1 + 1 });
});

test('gives uniforms blocks and varyings locations', () => {
  const made = forSpirv('#version 300 es\nuniform sampler2D map;\nuniform highp vec3 a, b;\nvarying vec2 uv;\n');
  assert.equal(
    made,
    '#version 450\nlayout(binding = 0) uniform sampler2D map;\n' +
      'layout(binding = 1) uniform Block2 { highp vec3 a, b; };\nlayout(location = 4) in vec2 uv;\n',
  );
});

test('the measured costs are those in `roughcast compare`', { skip: missing }, async () => {
  const measured = await costs();
  const [plain, portable, reflected, lambda1, d] = measured;
  // The pyramid looks the irradiance of an environment up a second time, from behind.
  assert.deepEqual(
    [portable, lambda1].map(([, , fetches]) => fetches - plain[2]),
    [1, 2],
  );
  // 16 look-ups of the environment, and as many of the table of albedos, replace a single one.
  assert.deepEqual([reflected[2] - portable[2], d[2] - lambda1[2]], [31, 31]);
  for (const dearer of [portable, reflected, lambda1, d]) assert.ok(dearer[1] > plain[1], `${dearer}`);
  const table = path.join(repository, 'crates/pipeline/src/compare/shading.json');
  const { version } = JSON.parse(readFileSync(path.join(example, 'node_modules/three/package.json'), 'utf8'));
  const { source, shading } = JSON.parse(readFileSync(table, 'utf8'));
  const names = Object.keys(shading);
  const now = Object.fromEntries(measured.map(([, operations, fetches], i) => [names[i], { operations, fetches }]));
  if (process.env.COSTS === 'overwrite') {
    const rows = names.map(
      (name) => `    "${name}": { "operations": ${now[name].operations}, "fetches": ${now[name].fetches} }`,
    );
    const text = source.replace(/three\.js [\d.]+/, `three.js ${version}`);
    writeFileSync(table, `{\n  "source": "${text}",\n  "shading": {\n${rows.join(',\n')}\n  }\n}\n`);
  } else {
    assert.deepEqual(shading, now, 'COSTS=overwrite npm test writes the table anew');
    assert.match(source, new RegExp(`^three\\.js ${version},`));
  }
});
