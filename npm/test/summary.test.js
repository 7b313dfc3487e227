// The command line on WebAssembly prints what the native tool prints.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { cpSync, readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import process from 'node:process';
import test from 'node:test';
import { fixed, notesToActOn, printable, summary, total } from '../roughcast/lib/cli/summary.js';
import { binary, fixtures, noBinary, noModule, npm, temporary } from './common.js';

/** Returns the outcome of a bake to `a.glb`, whose first material has the note `use another`. */
function outcome(sizes, inputBytes) {
  const layer = (index, notes) => ({ index, material: `M${index}`, layer: 'base', model: 'isotropic', notes });
  const note = { kind: 'lossySource', asksForAction: true, text: 'use another' };
  const bytes = Object.values(sizes).reduce((a, b) => a + b);
  const layers = [layer(0, [note]), { ...layer(0, []), layer: 'clearcoat' }, layer(1, [note])];
  return { input: 'a.glb', status: 'baked', inputBytes, bytes, seconds: 0.5, layers, textures: [{}, {}], sizes };
}

test('an asset is one line with its sizes, and notes are told once', () => {
  const sizes = { ktx2: 1_900_000, fallback: 0, images: 3_000_000, geometry: 4_100_000, json: 20_000 };
  const asset = outcome(sizes, 7_200_000);
  assert.equal(
    summary(asset),
    'baked a.glb: 2 materials, 2 textures, 7.2 -> 9.0 MB (KTX2 1.9, images 3.0, geometry 4.1), 0.50 s\n',
  );
  assert.equal(notesToActOn([asset]), '  note: M0; M1: use another\n');
  const other = { ...asset, input: 'b.glb', layers: asset.layers.slice(0, 1) };
  const failed = { input: 'c.glb', status: 'failed', error: 'broken' };
  assert.equal(notesToActOn([asset, failed, other]), '  note: a.glb (M0); a.glb (M1); b.glb (M0): use another\n');
});

test('an asset without bumps has its sizes too', () => {
  const sizes = { ktx2: 0, fallback: 0, images: 3_000_000, geometry: 0, json: 0 };
  const asset = { ...outcome(sizes, 3_100_000), layers: [] };
  assert.equal(summary(asset), 'baked a.glb: 2 textures, 3.1 -> 3.0 MB (images 3.0), 0.50 s\n');
  assert.equal(
    summary({ ...asset, status: 'copied', textures: [] }),
    'copied a.glb: no normal or height maps, 3.1 -> 3.0 MB (images 3.0), 0.50 s\n',
  );
});

test('several assets have a line of totals', () => {
  const one = outcome({ ktx2: 2_000, fallback: 1_000, images: 0, geometry: 0, json: 900 }, 500);
  const failed = { input: 'b.glb', status: 'failed', error: 'broken' };
  assert.equal(total([one], 0), '');
  assert.equal(total([failed, failed], 0), '');
  assert.equal(
    total([one, failed, one], 0.25),
    'total of 2 assets and 1 failed: 4 materials, 4 textures, 1.0 -> 7.8 kB (KTX2 4.0, PNG copies 2.0, JSON 1.8), ' +
      '0.25 s\n',
  );
});

test('numbers are rounded as Rust rounds them', () => {
  const tenths = [0.25, 0.35, 0.75, 1.25, 1234.25, 0.05].map((number) => fixed(number, 1));
  assert.deepEqual(tenths, ['0.2', '0.3', '0.8', '1.2', '1234.2', '0.1']);
  assert.deepEqual([fixed(0.125, 2), fixed(0.375, 2)], ['0.12', '0.38']);
});

test('characters that a terminal acts on are escaped', () => {
  assert.equal(printable('é\u001b[0m\n\u202e'), 'é\\u{1b}[0m\\u{a}\\u{202e}');
});

/** Returns a report without what differs between the tools: times, ids of jobs, messages, and the output folder. */
function comparable(file, output) {
  const { assets, ...run } = JSON.parse(readFileSync(file));
  const stable = ({ job, seconds, error, output: document, ...asset }) => {
    assert.equal(typeof seconds, 'number');
    return { ...asset, failed: Boolean(error), output: document && path.relative(output, document) };
  };
  return { ...run, assets: assets.map(stable) };
}

const ALL = [
  [],
  ['--verbose'],
  ['--engine', 'godot'],
  ['--gltf', 'fallback', '--glb=false', '--textures', 'all'],
  ['--glb'],
];
for (const options of ALL) {
  test(`summaries and reports of ${options.join(' ') || 'the defaults'}`, { skip: noBinary || noModule }, (t) => {
    const folder = temporary(t);
    cpSync(fixtures, path.join(folder, 'assets'), { recursive: true });
    writeFileSync(path.join(folder, 'assets/flat.gltf'), '{"asset": {"version": "2.0"}}');
    writeFileSync(path.join(folder, 'assets/broken.gltf'), '{');
    const printed = (output, ...command) => {
      const report = path.join(folder, `${output}.json`);
      const args = [...command, 'bake', 'assets', '-o', output, '--no-config', '--report', report, ...options];
      const env = { ...process.env, ROUGHCAST_BACKEND: 'wasm' };
      const { status, stdout } = spawnSync(args[0], args.slice(1), { cwd: folder, env, encoding: 'utf8' });
      assert.equal(status, 1, 'one asset is broken');
      return [stdout.replace(/\d+\.\d\d s$/gm, 'TIME').split('\n'), comparable(report, output)];
    };
    const native = printed('native', binary);
    assert.match(native[0].join('\n'), /^total of \d+ assets and 1 failed: .* TIME$/m);
    assert.deepEqual(printed('wasm', process.execPath, path.join(npm, 'roughcast/bin/roughcast.js')), native);
  });
}
