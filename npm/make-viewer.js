// Bundles the viewer of plugins/three for the package: `node make-viewer.js [--out out/viewer]`. Node serves the folder
// by its `show.js`, without a checkout, other packages or a network. The native tool embeds the folder (`build.rs`).
import { cpSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import process from 'node:process';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { rolldown } from 'rolldown';

const npm = path.dirname(fileURLToPath(import.meta.url));
const plugin = path.join(path.dirname(npm), 'plugins/three');
const three = path.join(npm, 'node_modules/three');

/** What the page imports by the names of packages. */
const PACKAGES = {
  'three/addons': path.join(three, 'examples/jsm'),
  three: path.join(three, 'build/three.module.js'),
  'three-roughcast': path.join(plugin, 'plugin/src/index.js'),
};

/** Decoders of three.js, which the page loads when an asset needs them. */
const DECODERS = [
  'basis/basis_transcoder.js',
  'basis/basis_transcoder.wasm',
  'draco/gltf/draco_decoder.wasm',
  'draco/gltf/draco_wasm_wrapper.js',
].map((name) => `examples/jsm/libs/${name}`);

/** Modules that Node runs, and the modules of the page that they share. */
const SERVER = ['server.js', 'show.js', 'page/refusal.js', 'page/variants.js'];

const LICENCES = `The page of this folder has parts of other projects:

- three.js, MIT: three/LICENSE
- Basis Universal's transcoder, Apache-2.0: LICENSE-APACHE of this package
- Draco's decoder, Apache-2.0: LICENSE-APACHE of this package
- the decoder of meshoptimizer, MIT, Copyright (c) 2016-2026 Arseny Kapoulkine
- ktx-parse, MIT, Copyright (c) 2020 Don McCurdy
- zstddec, MIT, Copyright (c) 2020 Don McCurdy
- Zstandard, BSD-3-Clause, Copyright (c) Meta Platforms, Inc. and affiliates
`;

/** Writes the viewer to a folder, which is emptied first. */
export async function makeViewer(out) {
  rmSync(out, { recursive: true, force: true });
  mkdirSync(path.join(out, 'page'), { recursive: true });
  const bundle = await rolldown({ input: path.join(plugin, 'page/main.js'), resolve: { alias: PACKAGES } });
  await bundle.write({ file: path.join(out, 'page/main.js'), minify: true });
  await bundle.close();
  // The bundle has the packages that the import map names.
  const html = readFileSync(path.join(plugin, 'page/index.html'), 'utf8');
  writeFileSync(path.join(out, 'page/index.html'), html.replace(/<script type="importmap">[^]*?<\/script>\n/, ''));
  cpSync(path.join(plugin, 'page/style.css'), path.join(out, 'page/style.css'));
  for (const name of SERVER) cpSync(path.join(plugin, name), path.join(out, name));
  for (const name of ['LICENSE', ...DECODERS]) cpSync(path.join(three, name), path.join(out, 'three', name));
  writeFileSync(path.join(out, 'LICENSES.md'), LICENCES);
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const { values } = parseArgs({ options: { out: { type: 'string', default: path.join(npm, 'out/viewer') } } });
  await makeViewer(path.resolve(values.out));
  process.stdout.write(`${path.resolve(values.out)}\n`);
}
