// The native tool and WebAssembly write the same bytes.
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
function bakeFile(file, settings, backend) {
  const beside = (name) => readFileSync(path.join(path.dirname(file), name));
  return bake(readFileSync(file), { name: path.parse(file).name, files: beside, settings, backend });
}

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
  { target: 'float', profile: 'both', frame: 'natural', distribution: 'normal', lobe: 'beckmann' },
]) {
  test(`documents with ${JSON.stringify(settings)}`, options, async (t) => {
    for (const file of documents) {
      await t.test(path.basename(file), async () => {
        assertSame(await bakeFile(file, settings, 'native'), await bakeFile(file, settings, 'wasm'));
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
    const bakeWith = (backend) => bakeMap(image, { ...mapOptions, name: path.basename(name), backend });
    assertSame(await bakeWith('native'), await bakeWith('wasm'));
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
