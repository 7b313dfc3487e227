// The packed packages, installed in an empty folder, as a newcomer has them.
import assert from 'node:assert/strict';
import { cpSync, existsSync, mkdirSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import process from 'node:process';
import test from 'node:test';
import { fixtures, npm, run, temporary } from './common.js';
import { environment, npx, options, packages, project } from './packed.js';

/** Returns the JSON of a .glb. */
function jsonOf(file) {
  const bytes = readFileSync(file);
  assert.equal(bytes.toString('latin1', 0, 4), 'glTF');
  return JSON.parse(bytes.toString('utf8', 20, 20 + bytes.readUInt32LE(12)));
}

/** Files of the main package that are not in the repository. */
const WITHOUT_SOURCE = [
  'roughcast.threads.wasm',
  'roughcast.wasm',
  'viewer/page/index.html',
  'viewer/page/main.js',
  'viewer/three/LICENSE',
];

test('the packages hold what they need and nothing else', options, () => {
  const list = (file) =>
    run('tar', ['-tzf', file])
      .trim()
      .split('\n')
      .map((name) => name.replace('package/', ''));
  const licences = ['LICENSE-APACHE', 'LICENSE-MIT', 'README.md', 'package.json'];
  assert.deepEqual(list(packages.platform).sort(), [...licences, 'bin/roughcast'].sort());
  const names = list(packages.main);
  for (const name of [...licences, 'bin/roughcast.js', 'index.d.ts', 'lib/index.js', ...WITHOUT_SOURCE]) {
    assert.ok(names.includes(name), name);
  }
  assert.deepEqual(
    names.filter((name) => /test|node_modules|\.rs$/.test(name)),
    [],
  );
});

test('the command line bakes natively and by WebAssembly, to the same bytes', options, (t) => {
  const native = project(t, [packages.platform, packages.main]);
  const wasm = project(t, [packages.main]);
  assert.ok(existsSync(path.join(native, 'node_modules/@roughcast')));
  assert.ok(!existsSync(path.join(wasm, 'node_modules/@roughcast')));
  assert.doesNotMatch(npx(native, '--version'), /WebAssembly/);
  assert.match(npx(wasm, '--version'), /WebAssembly/);
  // Explicit forms: the defaults of the two must not be what is compared here.
  for (const folder of [native, wasm]) npx(folder, 'bake', 'model.glb', '-o', 'out', '--glb', '--gltf', 'strict');
  const [one, two] = [native, wasm].map((folder) => readFileSync(path.join(folder, 'out/model.glb')));
  assert.ok(one.equals(two));
  assert.ok(jsonOf(path.join(wasm, 'out/model.glb')).extensionsRequired.includes('KHR_texture_basisu'));
  // A document with a name of its own records the name of its source.
  for (const folder of [native, wasm]) npx(folder, 'bake', 'model.glb', '-o', 'baked.glb', '--gltf', 'strict');
  const named = [native, wasm].map((folder) => readFileSync(path.join(folder, 'baked.glb')));
  assert.ok(named[0].equals(named[1]));
  assert.equal(jsonOf(path.join(wasm, 'baked.glb')).asset.extras.roughcast.source, 'model.glb');
});

test('both command lines refuse the same names of outputs', options, (t) => {
  const folders = [[packages.platform, packages.main], [packages.main]].map((installed) => project(t, installed));
  for (const folder of folders) mkdirSync(path.join(folder, 'folder.glb'));
  const refused = (folder, args) => {
    try {
      return npx(folder, 'bake', ...args);
    } catch ({ status, stderr }) {
      return { status, stderr };
    }
  };
  for (const args of [
    ['model.glb', '-o', 'w.zip'],
    ['model.glb', '-o', 'x.GLB'],
    ['model.glb', '-o', 'folder.glb'],
    ['model.glb', 'model.glb', '-o', 'x.glb'],
    ['folder.glb', '-o', 'x.glb'],
    ['model.glb', '-o', 'x.gltf', '--glb'],
  ]) {
    const [native, wasm] = folders.map((folder) => refused(folder, args));
    assert.equal(native.status, 2, args.join(' '));
    assert.deepEqual(wasm, native);
  }
  assert.ok(!existsSync(path.join(folders[1], 'w.zip')));
});

test('one command bakes in an empty folder, and its time is printed', options, (t) => {
  const { main, platform } = packages;
  for (const installed of [[main, platform], [main]]) {
    const folder = temporary(t);
    cpSync(path.join(fixtures, 'waves/waves.glb'), path.join(folder, 'model.glb'));
    const named = installed.flatMap((name) => ['--package', name]);
    const command = ['--yes', '--offline', ...named, 'roughcast', 'bake', 'model.glb', '-o', 'baked.glb', '--glb'];
    const started = performance.now();
    run('npx', command, { cwd: folder, env: environment });
    const seconds = (performance.now() - started) / 1e3;
    t.diagnostic(`${installed.length === 2 ? 'native' : 'WebAssembly'}: ${seconds.toFixed(1)} s`);
    assert.ok(existsSync(path.join(folder, 'baked.glb')));
  }
});

test('WebAssembly bakes folders, names files, and refuses what it cannot do', options, (t) => {
  const folder = project(t, [packages.main]);
  mkdirSync(path.join(folder, 'assets/deep'), { recursive: true });
  cpSync(path.join(fixtures, 'heights'), path.join(folder, 'assets'), { recursive: true });
  cpSync(path.join(folder, 'model.glb'), path.join(folder, 'assets/deep/model.glb'));
  npx(folder, 'bake', 'assets', '-o', 'out', '--report', 'report.json');
  assert.ok(existsSync(path.join(folder, 'out/heights.gltf')));
  assert.ok(existsSync(path.join(folder, 'out/heights.bin')), 'unchanged files are copied');
  assert.ok(jsonOf(path.join(folder, 'out/deep/model.glb')));
  const report = JSON.parse(readFileSync(path.join(folder, 'report.json')));
  assert.deepEqual(
    report.assets.map((asset) => asset.status),
    ['baked', 'baked'],
  );

  npx(folder, 'bake', 'model.glb', '-o', 'split', '--glb=false', '--scale-normals=false');
  assert.ok(existsSync(path.join(folder, 'split/model.gltf')));
  npx(folder, 'bake', 'model.glb', '-o', 'named.glb');
  assert.ok(jsonOf(path.join(folder, 'named.glb')).images.some((image) => image.mimeType === 'image/ktx2'));
  npx(folder, 'map', 'assets/heights.png', '--height', '-o', 'map/heights.ktx2');
  assert.deepEqual(readdirSync(path.join(folder, 'map')), ['heights.ktx2']);

  const before = readFileSync(path.join(folder, 'model.glb'));
  const fails = (pattern, status, ...args) =>
    assert.throws(
      () => npx(folder, ...args),
      (error) => pattern.test(error.stderr) && error.status === status,
    );
  fails(/no source/, 1, 'bake', 'model.glb', '-o', '.');
  fails(/native tool/, 2, 'check', 'out');
  fails(/-o/, 2, 'bake', 'model.glb');
  fails(/nosuch/, 1, 'bake', 'nosuch.glb', '-o', 'out');
  fails(/max-error/, 1, 'bake', 'model.glb', '-o', 'out', '--max-error', '2');
  fails(/expected a number/, 2, 'bake', 'model.glb', '-o', 'out', '--max-error', 'x');
  fails(/expected true or false/, 2, 'bake', 'model.glb', '-o', 'out', '--scale-normals=x');
  fails(/\.ktx2/, 2, 'map', 'assets/heights.png', '-o', 'heights.png');
  assert.ok(readFileSync(path.join(folder, 'model.glb')).equals(before));
});

test('the library transforms a GLB with both backends', options, (t) => {
  // Stands in for the registry: the copies that the tests of this repository have.
  const modules = (folder) => {
    const scope = path.join(folder, 'node_modules');
    for (const name of ['@gltf-transform', 'property-graph', 'ktx-parse']) {
      cpSync(path.join(npm, 'node_modules', name), path.join(scope, name), { recursive: true });
    }
  };
  const script = `
    import { NodeIO } from '@gltf-transform/core';
    import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
    import { RoughnessPyramid, roughcast } from 'roughcast';
    const io = new NodeIO().registerExtensions([...ALL_EXTENSIONS, RoughnessPyramid]);
    const document = await io.read('model.glb');
    await document.transform(roughcast({ profile: 'both' }));
    await io.write('out.glb', document);
  `;
  const { main, platform } = packages;
  const [one, two] = [[platform, main], [main]].map((installed) => {
    const folder = project(t, installed);
    modules(folder);
    writeFileSync(path.join(folder, 'script.js'), script);
    run(process.execPath, ['script.js'], { cwd: folder, env: environment });
    const { extensionsUsed, images } = jsonOf(path.join(folder, 'out.glb'));
    assert.ok(extensionsUsed.includes('ROUGHCAST_materials_roughness_pyramid'));
    assert.ok(images.some((image) => image.mimeType === 'image/ktx2'));
    return readFileSync(path.join(folder, 'out.glb'));
  });
  assert.ok(one.equals(two));
});
