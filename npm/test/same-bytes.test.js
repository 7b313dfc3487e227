// The native tool and WebAssembly write the same bytes, with any number of threads.
import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import path from 'node:path';
import process from 'node:process';
import test from 'node:test';
import { bake, bakeMap } from 'roughcast';
import { binary, fixtures, noBinary, noModule } from './common.js';

process.env.ROUGHCAST_BINARY = binary ?? '';
const options = { skip: noBinary || noModule };

const documents = readdirSync(fixtures).flatMap((name) =>
  readdirSync(path.join(fixtures, name))
    .filter((file) => /\.(gltf|glb)$/.test(file))
    .map((file) => path.join(fixtures, name, file)),
);

/** Bakes a document of the fixtures. */
function bakeFile(file, settings, backend, threads) {
  const beside = (name) => readFileSync(path.join(path.dirname(file), name));
  return bake(readFileSync(file), { name: path.parse(file).name, files: beside, settings, backend, threads });
}

/** Numbers of threads: the module of one thread, and the module of several with a number that divides no size. */
const THREADS = [1, 3];

/** Returns the first difference of two buffers as text; undefined if there is none. */
function difference(a, b) {
  if (a.length !== b.length) return `${a.length} and ${b.length} bytes`;
  const at = a.findIndex((byte, index) => byte !== b[index]);
  return at < 0 ? undefined : `byte ${at}`;
}

function assertSame(native, wasm) {
  const all = ({ document, files }) => [document, ...files].filter(Boolean);
  assert.deepEqual(
    all(wasm).map((file) => file.path),
    all(native).map((file) => file.path),
  );
  const differences = all(native).map((file, index) => difference(file.bytes, all(wasm)[index].bytes));
  assert.deepEqual(
    differences,
    differences.map(() => undefined),
  );
  assert.deepEqual(wasm.report, native.report);
}

for (const settings of [
  {},
  { profile: 'both', gltf: 'fallback', glb: false },
  { profile: 'both', model: 'anisotropic', quality: 'best', glb: true },
  { engine: 'bevy', rdo: 0.5, glb: false },
  { ownAnisotropy: 'keep', scaleNormals: false, glb: true },
  { target: 'float', profile: 'both', frame: 'natural', distribution: 'normal', lobe: 'beckmann' },
]) {
  test(`documents with ${JSON.stringify(settings)}`, options, async (t) => {
    for (const file of documents) {
      await t.test(path.basename(file), async () => {
        const native = await bakeFile(file, settings, 'native');
        for (const threads of THREADS) assertSame(native, await bakeFile(file, settings, 'wasm', threads));
      });
    }
  });
}

for (const [name, mapOptions] of [
  ['maps/vgroove_normal.png', { roughnessFactor: 0.3 }],
  ['maps/two_channel_normal.png', { channels: 'xy', greenDown: true, settings: { profile: 'both' } }],
  ['maps/dunes_height.exr', { height: true, heightScale: 0.1, wrap: ['repeat', 'clamp'] }],
  ['brushed/brushed_normal.png', { roughnessFactor: 0.5, settings: { target: 'float', profile: 'pyramid' } }],
  ['real/gravel_normal.jpg', { roughnessFactor: 0.4, settings: { quality: 'best', rdo: 1 } }],
]) {
  test(`the map ${name}`, options, async () => {
    const image = readFileSync(path.join(fixtures, name));
    const bakeWith = (backend, threads) =>
      bakeMap(image, { ...mapOptions, name: path.basename(name), backend, threads });
    const native = await bakeWith('native');
    for (const threads of THREADS) assertSame(native, await bakeWith('wasm', threads));
  });
}

test('a roughness map is read beside the map', options, async () => {
  const read = (name) => readFileSync(path.join(fixtures, 'brushed', name));
  const roughness = { image: read('brushed_surface.png'), name: 'brushed_surface.png' };
  const bakeWith = (backend) =>
    bakeMap(read('brushed_normal.png'), { name: 'brushed_normal.png', roughness, roughnessFactor: 0.8, backend });
  const [native, wasm] = [await bakeWith('native'), await bakeWith('wasm')];
  assert.ok(wasm.files.length > 1);
  assertSame(native, wasm);
});

test('any number of threads, also without a number', options, async () => {
  const file = path.join(fixtures, 'waves/waves.glb');
  const settings = { profile: 'both', quality: 'best', rdo: 1 };
  const native = await bakeFile(file, settings, 'native', 1);
  for (const threads of [undefined, 0, 2, 5, 17]) {
    assertSame(native, await bakeFile(file, settings, 'wasm', threads));
    if (threads !== 5) continue;
    // Bakes at the same time do not share a memory.
    const several = await Promise.all([1, 2, 2].map((count) => bakeFile(file, settings, 'wasm', count)));
    for (const one of several) assertSame(native, one);
  }
  for (const threads of [-1, 1.5, 65, '2', NaN]) {
    await assert.rejects(bakeFile(file, {}, 'wasm', threads), /threads: expected a whole number from 0 to 64/);
  }
});

test('progress rises to 1, and threads report what is wrong', options, async () => {
  const shares = [];
  const onProgress = (share) => shares.push(share);
  const glb = readFileSync(path.join(fixtures, 'waves/waves.glb'));
  await bake(glb, { backend: 'wasm', threads: 2, onProgress });
  assert.deepEqual(shares, shares.toSorted());
  assert.equal(shares.at(-1), 1);
  const unfinished = bakeFile(documents[0], { maxError: 2 }, 'wasm', 4);
  await assert.rejects(unfinished, /max-error/);
});

test('both name the missing files and the wrong setting', options, async () => {
  const waves = readFileSync(path.join(fixtures, 'brushed/brushed.gltf'));
  for (const backend of ['native', 'wasm']) {
    await assert.rejects(bake(waves, { backend }), /brushed_normal\.png/);
    await assert.rejects(bakeFile(documents[0], { maxError: 2 }, backend), /max-error/);
    await assert.rejects(bakeFile(documents[0], { qualty: 'best' }, backend), /qualty/);
    await assert.rejects(bake(new Uint8Array(3), { backend }), /glTF|JSON/);
    await assert.rejects(bakeMap(new Uint8Array(3), { backend }), /map\.png/);
  }
});
