// Makes the try-it page: `node make-page.js [--out out/page]`. Any web server of static files can serve the folder.
//
// Copies page/, the library with its WebAssembly module, and what the page needs of three.js and of the viewer in
// plugins/three; packs the samples from fixtures/.
import { cpSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import process from 'node:process';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';

const npm = path.dirname(fileURLToPath(import.meta.url));
const repository = path.dirname(npm);
const { values } = parseArgs({ options: { out: { type: 'string', default: path.join(npm, 'out/page') } } });
const out = path.resolve(values.out);

/** Files of three.js: the library, loaders, decoders, and what they import. */
const THREE = [
  'build/three.module.js',
  'build/three.core.js',
  'examples/jsm/environments/RoomEnvironment.js',
  'examples/jsm/libs/basis/basis_transcoder.js',
  'examples/jsm/libs/basis/basis_transcoder.wasm',
  'examples/jsm/libs/draco/gltf/draco_decoder.js',
  'examples/jsm/libs/draco/gltf/draco_decoder.wasm',
  'examples/jsm/libs/draco/gltf/draco_wasm_wrapper.js',
  'examples/jsm/libs/ktx-parse.module.js',
  'examples/jsm/libs/meshopt_decoder.module.js',
  'examples/jsm/libs/zstddec.module.js',
  'examples/jsm/loaders/DRACOLoader.js',
  'examples/jsm/loaders/GLTFLoader.js',
  'examples/jsm/loaders/KTX2Loader.js',
  'examples/jsm/math/ColorSpaces.js',
  'examples/jsm/utils/BufferGeometryUtils.js',
  'examples/jsm/utils/SkeletonUtils.js',
  'examples/jsm/utils/WorkerPool.js',
  'LICENSE',
];

/** Modules of the library, below roughcast/lib, that browsers need. */
const LIBRARY = [
  'backend.browser.js',
  'backend.wasm.js',
  'bake.js',
  'message.js',
  'names.js',
  'settings.js',
  'thread.browser.js',
  'thread.js',
  'threads.js',
  'wasm.js',
  'worker.browser.js',
];

/** The WebAssembly modules. */
const MODULES = ['roughcast.wasm', 'roughcast.threads.wasm'];

/** Modules of the viewer that the page shares. */
const VIEWER = [
  'bytes.js',
  'compose.js',
  'density.js',
  'direction.js',
  'measure.js',
  'ramp.js',
  'refusal.js',
  'start.js',
  'subject.js',
  'supersample.js',
  'surroundings.js',
];

/** Samples, by the names that they have on the page. */
const SAMPLES = { waves: 'waves/waves.glb', brushed: 'brushed/brushed.gltf', knobs: 'knobs/knobs.gltf' };

/** Copies a file, with the folders above it. */
function copy(from, to) {
  mkdirSync(path.dirname(to), { recursive: true });
  cpSync(from, to);
}

rmSync(out, { recursive: true, force: true });
cpSync(path.join(npm, 'page'), out, { recursive: true });
for (const name of THREE) copy(path.join(npm, 'node_modules/three', name), path.join(out, 'three', name));
for (const name of VIEWER) {
  const file = path.join(repository, 'plugins/three/page', name);
  for (const [, module] of readFileSync(file, 'utf8').matchAll(/ from '\.\/(.*)';/g)) {
    if (!VIEWER.includes(module)) throw new Error(`${file}: expected imports among VIEWER, found ${module}; add it`);
  }
  copy(file, path.join(out, 'viewer', name));
}

for (const name of MODULES) copy(path.join(npm, 'roughcast', name), path.join(out, 'roughcast', name));
for (const name of LIBRARY) {
  const text = readFileSync(path.join(npm, 'roughcast/lib', name), 'utf8');
  mkdirSync(path.join(out, 'roughcast/lib'), { recursive: true });
  // Browsers know no `imports` of package.json, and import maps do not hold in workers.
  writeFileSync(path.join(out, 'roughcast/lib', name), text.replace(/'#(backend|worker)'/, "'./$1.browser.js'"));
}

const io = new NodeIO().registerExtensions(ALL_EXTENSIONS);
mkdirSync(path.join(out, 'samples'));
for (const [name, file] of Object.entries(SAMPLES)) {
  const document = await io.read(path.join(repository, 'fixtures', file));
  writeFileSync(path.join(out, 'samples', `${name}.glb`), await io.writeBinary(document));
}
process.stdout.write(`${out}\n`);
