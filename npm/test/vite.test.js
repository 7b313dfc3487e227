// Tests that Vite's build and its server give pages baked assets.
import assert from 'node:assert/strict';
import { cp, mkdir, mkdtemp, readFile, readdir, realpath, rm, writeFile } from 'node:fs/promises';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { setTimeout } from 'node:timers/promises';
import { fileURLToPath } from 'node:url';

import { bake } from 'roughcast';
import { roughcast } from 'roughcast/vite';
import { build, createServer } from 'vite';
import { noModule } from './common.js';

const FIXTURE = fileURLToPath(new URL('../../fixtures/tiny', import.meta.url));
// Without roughness, levels miss the bound, and a warning names the model that helps.
const SETTINGS = { engine: 'three', model: 'none' };

let root;
let expected;

before(async () => {
  // Vite resolves links, and the temporary folder of macOS is one.
  root = await realpath(await mkdtemp(path.join(os.tmpdir(), 'roughcast-vite-')));
  await cp(FIXTURE, path.join(root, 'tiny'), { recursive: true });
  await writeFile(path.join(root, 'index.html'), '<script type="module" src="/main.js"></script>');
  await writeFile(path.join(root, 'main.js'), "import url from './tiny/tiny.gltf?roughcast'; document.title = url;");
  const files = (name) => readFile(path.join(FIXTURE, name));
  const baked = await bake(await files('tiny.gltf'), { name: 'tiny', files, settings: { ...SETTINGS, glb: true } });
  expected = Buffer.from(baked.document.bytes);
});

after(() => rm(root, { recursive: true, force: true }));

/** Returns a configuration whose cache is in the temporary folder, and the warnings that Vite prints. */
function configuration() {
  const warnings = [];
  const print = (text) => warnings.push(text);
  const customLogger = { info() {}, clearScreen() {}, hasErrorLogged: () => false, hasWarned: false };
  Object.assign(customLogger, { warn: print, warnOnce: print, error: print });
  const cacheDir = path.join(root, 'cache');
  return { warnings, root, cacheDir, configFile: false, customLogger, plugins: [roughcast(SETTINGS)] };
}

test('a build emits the baked asset', async () => {
  const { warnings, ...config } = configuration();
  await build(config);
  const assets = await readdir(path.join(root, 'dist/assets'));
  const [asset] = assets.filter((name) => name.endsWith('.glb'));
  assert.deepEqual(await readFile(path.join(root, 'dist/assets', asset)), expected);
  assert.ok(warnings.some((text) => text.includes('tiny.gltf') && text.includes('--max-error')), warnings.join('\n'));
});

test('a build of a page that bakes emits both modules and the worker', { skip: noModule }, async () => {
  const page = path.join(root, 'page');
  await mkdir(page);
  await writeFile(path.join(page, 'index.html'), '<script type="module" src="/main.js"></script>');
  await writeFile(path.join(page, 'main.js'), "import { bake } from 'roughcast/bake'; await bake(new Uint8Array(3));");
  const alias = { 'roughcast/bake': fileURLToPath(new URL('../roughcast/lib/bake.js', import.meta.url)) };
  const { warnings, ...config } = configuration();
  await build({ ...config, root: page, resolve: { alias }, plugins: [], build: { target: 'esnext' } });
  const assets = await readdir(path.join(page, 'dist/assets'));
  for (const pattern of [/^roughcast-.*\.wasm$/, /^roughcast\.threads-.*\.wasm$/, /^thread\.browser-.*\.js$/]) {
    assert.equal(assets.filter((name) => pattern.test(name)).length, 1, `${pattern}: ${assets}`);
  }
  assert.deepEqual(warnings, []);
});

test('the server sends the baked asset, and bakes again when a texture is saved', async () => {
  const { warnings, ...config } = configuration();
  const server = await createServer({ ...config, server: { host: '127.0.0.1', port: 0 } });
  try {
    await server.listen();
    const { port } = server.httpServer.address();
    const asset = async () => {
      const { default: url } = await server.ssrLoadModule('/tiny/tiny.gltf?roughcast');
      const response = await fetch(`http://127.0.0.1:${port}${url}`);
      return Buffer.from(await response.arrayBuffer());
    };
    assert.deepEqual(await asset(), expected, warnings.join('\n'));

    await cp(path.join(FIXTURE, 'cloth_surface.png'), path.join(root, 'tiny/cloth_normal.png'));
    const end = Date.now() + 60_000;
    while ((await asset()).equals(expected)) {
      assert.ok(Date.now() < end, 'the asset was not baked again');
      await setTimeout(100);
    }
  } finally {
    await server.close();
  }
});
