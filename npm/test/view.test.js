// `npx roughcast view` of the packed package, in headless Chromium. Screenshots are left in target/npm.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { cpSync, existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import process from 'node:process';
import { createInterface } from 'node:readline';
import test from 'node:test';
import { chromium } from 'playwright-core';
import { fixtures, repository } from './common.js';
import { environment, npx, options as packed, packages, project } from './packed.js';

const executablePath = process.env.CHROMIUM ?? '/usr/bin/chromium';
const noBrowser = existsSync(executablePath) ? false : `needs Chromium at ${executablePath} (or $CHROMIUM)`;
const options = { skip: packed.skip || noBrowser };
const hasEncoders = existsSync(path.join(repository, 'plugins/three/node_modules/draco3d'));
const SHOTS = path.join(repository, 'target/npm');
const ARGUMENTS = ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic'];

/** Runs `roughcast view` in a folder until the test ends. Returns the address of the page. */
async function view(t, folder, ...args) {
  const tool = path.join(folder, 'node_modules/roughcast/bin/roughcast.js');
  const child = spawn(process.execPath, [tool, 'view', ...args], { cwd: folder, env: environment });
  t.after(() => child.kill());
  let complaint = '';
  child.stderr.on('data', (text) => (complaint += text));
  for await (const line of createInterface({ input: child.stdout })) return line;
  throw new Error(complaint);
}

/** Opens the page. Collects its problems, and the hosts that are asked. */
async function open(t, url) {
  const browser = await chromium.launch({ executablePath, args: ARGUMENTS });
  t.after(() => browser.close());
  const context = await browser.newContext({ viewport: { width: 1000, height: 640 }, reducedMotion: 'reduce' });
  const page = await context.newPage();
  page.setDefaultTimeout(120_000);
  Object.assign(page, { problems: [], hosts: new Set() });
  page.on('pageerror', (error) => page.problems.push(String(error)));
  page.on('console', (message) => {
    // Software rendering warns about reads of pixels, which the screenshots are.
    const isOfDriver = /GL Driver Message|GPU stall/.test(message.text());
    if (['error', 'warning'].includes(message.type()) && !isOfDriver) page.problems.push(message.text());
  });
  page.on('request', (request) => {
    const { protocol, hostname } = new URL(request.url());
    if (!['blob:', 'data:'].includes(protocol)) page.hosts.add(hostname);
  });
  await page.goto(url);
  await page.waitForFunction(
    () => document.documentElement.dataset.ready || document.getElementById('problem').textContent,
  );
  assert.equal(await page.locator('#problem').textContent(), '');
  return page;
}

const titles = (page) => page.locator('#controls [name=left] option').allTextContents();

/** Waits for a picture with errors. Returns how many colours it has. */
async function colours(page, name) {
  await page.waitForFunction(() => /\d+ samples/.test(document.getElementById('note').textContent));
  const shot = await page.screenshot({ path: path.join(SHOTS, `${name}.png`) });
  return page.evaluate(async (data) => {
    const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
    const { x, y, width, height } = document.getElementById('canvas').getBoundingClientRect();
    const context = new OffscreenCanvas(width, height).getContext('2d');
    context.drawImage(bitmap, -x, -y);
    const pixels = new Uint32Array(context.getImageData(0, 0, width, height).data.buffer);
    return new Set(pixels).size;
  }, shot.toString('base64'));
}

test('shows an asset, its bakes and the truth without a checkout or a network', options, async (t) => {
  mkdirSync(SHOTS, { recursive: true });
  const folder = project(t, [packages.main]);
  cpSync(path.join(fixtures, 'brushed'), path.join(folder, 'assets'), { recursive: true });
  npx(folder, 'bake', 'assets', '-o', 'out/portable', '--engine', 'three');
  npx(folder, 'bake', 'assets', '-o', 'out/pyramid', '--profile', 'pyramid', '--engine', 'three');
  npx(folder, 'bake', 'model.glb', '-o', 'out');
  // The folders hold another asset, too.
  const page = await open(t, await view(t, folder, 'assets', 'out'));
  assert.deepEqual(await titles(page), ['Plain mips', 'Portable bake', 'Pyramid bake', 'Supersampled']);
  assert.ok((await colours(page, 'view')) > 500, 'a picture is drawn');
  // The map of the fixture has few texels, and more repeats of it show mips.
  assert.equal(await page.locator('[name=subject]').inputValue(), 'sphere');
  const footprint = await page.locator('#footprint').textContent();
  assert.match(footprint, /about 6\.\d x 6\.\d texels\. The maps are shown on a sphere/);
  assert.deepEqual(page.problems, []);
  assert.deepEqual([...page.hosts], ['127.0.0.1'], 'nothing leaves the machine');
});

test('shows files, with and without the native tool, and what is dropped on an empty page', options, async (t) => {
  const folder = project(t, [packages.main, packages.platform]);
  npx(folder, 'bake', 'model.glb', '-o', 'baked.glb');
  const page = await open(t, await view(t, folder, 'model.glb', 'baked.glb'));
  assert.deepEqual(await titles(page), ['Plain mips', 'Portable bake', 'Supersampled']);
  await page.goto(await view(t, folder));
  await page.locator('#empty').waitFor();
  await page.screenshot({ path: path.join(SHOTS, 'view-empty.png') });
  await page.locator('#files').setInputFiles(path.join(folder, 'baked.glb'));
  await page.waitForFunction(() => document.querySelectorAll('#figures tr').length === 1);
  assert.deepEqual(await titles(page), ['Portable bake']);
  assert.deepEqual(page.problems, []);
});

const compressed = { skip: options.skip || (!hasEncoders && 'needs npm ci --prefix plugins/three') };

test('decodes Draco and meshoptimizer', compressed, async (t) => {
  const folder = project(t, [packages.main]);
  const { withDraco, withMeshopt } = await import('../../plugins/three/test/compress.js');
  const source = path.join(fixtures, 'brushed');
  const gltf = JSON.parse(readFileSync(path.join(source, 'brushed.gltf'), 'utf8'));
  const bin = readFileSync(path.join(source, 'brushed.bin'));
  for (const { uri } of gltf.images) cpSync(path.join(source, uri), path.join(folder, uri));
  for (const [name, compress] of Object.entries({ draco: withDraco, meshopt: withMeshopt })) {
    writeFileSync(path.join(folder, `${name}.gltf`), JSON.stringify(await compress(gltf, bin)));
    const page = await open(t, await view(t, folder, `${name}.gltf`));
    assert.ok((await colours(page, `view-${name}`)) > 500, name);
    assert.deepEqual(page.problems, []);
    // Otherwise the page draws on while the next one works.
    await page.context().close();
  }
});

test('says what it cannot show', options, (t) => {
  const folder = project(t, [packages.main]);
  cpSync(path.join(folder, 'model.glb'), path.join(folder, 'copies/model.glb'));
  writeFileSync(path.join(folder, 'broken.gltf'), '{');
  const fails = (pattern, status, ...args) =>
    assert.throws(
      () => npx(folder, 'view', ...args),
      (error) => pattern.test(error.stderr) && error.status === status,
    );
  fails(/nosuch\.glb: expected .* found nothing/, 1, 'nosuch.glb');
  fails(/broken\.gltf: cannot be shown: /, 1, 'broken.gltf');
  const others = {
    'lfs.glb': ['version https://git-lfs.github.com/spec/v1\n', /Git LFS pointer .*`git lfs pull`$/m],
    'empty.glb': ['', /expected a glTF document, found an empty file; copy or export it again$/m],
    'm.fbx': ['Kaydara FBX Binary  \0', /expected a \.gltf or \.glb file, found a \.fbx file/],
    'map.ktx2': ['\u00abKTX 20\u00bb\r\n\x1a\n', /expected a glTF document, found something else$/m],
    'short.glb': ['glTF\x02\0\0\0', /found 8; the file is cut short$/m],
  };
  for (const [name, [content, message]] of Object.entries(others)) {
    writeFileSync(path.join(folder, name), content, 'latin1');
    fails(message, 1, name);
  }
  fails(/model\.glb and .*copies.*“Plain mips”/, 2, 'model.glb', 'copies');
  fails(/unknown/i, 2, '--unknown');
  assert.match(npx(folder, 'view', '--help'), /127\.0\.0\.1/);
});
