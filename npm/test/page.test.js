// The try-it page of a release as a person would use it, in headless Chromium. Screenshots are left in target/npm.
import assert from 'node:assert/strict';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import process from 'node:process';
import test, { after, before } from 'node:test';
import { chromium } from 'playwright-core';
import { PNG } from 'pngjs';
import { bake } from 'roughcast';
import { serve } from '../../plugins/three/server.js';
import { binary, fixtures, noBinary, noModule, npm, repository, run, temporary } from './common.js';

const executablePath = process.env.CHROMIUM ?? '/usr/bin/chromium';
const noBrowser = existsSync(executablePath) ? false : `needs Chromium at ${executablePath} (or $CHROMIUM)`;
const options = { skip: noModule || noBrowser };
const SHOTS = path.join(repository, 'target/npm');
const { version } = JSON.parse(readFileSync(path.join(npm, 'roughcast/package.json')));
/** The name of the archive without its extension, and of the folder in the archive. */
const NAME = `roughcast-page-${version}`;
const ARGUMENTS = ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic'];

let folder;
let server;
let isolated;
let browser;

before(async () => {
  if (options.skip) return;
  mkdirSync(SHOTS, { recursive: true });
  folder = mkdtempSync(path.join(os.tmpdir(), 'roughcast-page-'));
  run('bash', [path.join(repository, '.github/release/page-archive'), folder]);
  run('tar', ['-xzf', path.join(folder, `${NAME}.tar.gz`), '-C', folder]);
  server = await serve({ page: path.join(folder, NAME) });
  isolated = await serve({ page: path.join(folder, NAME) }, { isIsolated: true });
  browser = await chromium.launch({ executablePath, args: ARGUMENTS });
});
after(async () => {
  await browser?.close();
  await server?.close();
  await isolated?.close();
  if (folder) rmSync(folder, { recursive: true, force: true });
});

/** Opens the page and collects its problems and the hosts that it asks. */
async function open(settings = {}, { url } = server) {
  const context = await browser.newContext({ viewport: { width: 900, height: 800 }, ...settings });
  const page = await context.newPage();
  page.setDefaultTimeout(120_000);
  Object.assign(page, { problems: [], hosts: new Set(), files: new Set() });
  page.on('pageerror', (error) => page.problems.push(String(error)));
  page.on('console', (message) => {
    // Software rendering warns about reads of pixels, which the screenshots are.
    const isOfDriver = /GL Driver Message|GPU stall/.test(message.text());
    if (['error', 'warning'].includes(message.type()) && !isOfDriver) page.problems.push(message.text());
  });
  page.on('request', (request) => {
    const { protocol, host, pathname } = new URL(request.url());
    page.files.add(path.basename(pathname));
    if (!['blob:', 'data:'].includes(protocol)) page.hosts.add(host);
  });
  await page.goto(`${url}/page/index.html`);
  return page;
}

const finished = (page, state = 'done') => page.waitForFunction((s) => document.body.dataset.state === s, state);
/** Waits until the errors are measured: then all pictures are at their places. */
const measured = (page) =>
  page.waitForFunction(() => document.querySelector('[data-name=baked]')?.textContent.includes('error'));
const status = (page) => page.locator('#status').textContent();
const choose = (page, name, value) => page.locator(`[name=${name}]`).selectOption(value);

/** Returns the modules that the page has fetched. */
const modulesOf = (page) => [...page.files].filter((name) => /^roughcast.*\.wasm$/.test(name));

/** Opens a file through the button. */
const openFile = (page, name, buffer) =>
  page.locator('#file').setInputFiles({ name, mimeType: 'model/gltf-binary', buffer });

/** Returns the bytes of the download. */
async function download(page) {
  const [event] = await Promise.all([page.waitForEvent('download'), page.locator('#download').click()]);
  return { name: event.suggestedFilename(), bytes: readFileSync(await event.path()) };
}

/** Returns the labels of the pictures: name, text, error where it is known, and box. */
const labels = (page) =>
  // In one call, since each frame makes new labels.
  page.evaluate(() =>
    [...document.querySelectorAll('#labels span')].map((span) => ({
      name: span.dataset.name,
      text: span.textContent,
      error: Number(/error (\S+)/.exec(span.textContent)?.[1]),
      box: span.getBoundingClientRect().toJSON(),
    })),
  );

/** Returns the pixels of each third of the picture, as text. */
async function columnsOf(page) {
  const { data, width, height } = PNG.sync.read(await page.locator('#canvas').screenshot());
  const third = Math.floor(width / 3);
  return [0, 1, 2].map((column) => {
    const rows = Array.from({ length: height }, (_, y) =>
      data.subarray(4 * (y * width + column * third), 4 * (y * width + (column + 1) * third)),
    );
    return Buffer.concat(rows.slice(height >> 1)).toString('base64');
  });
}

/** Khronos' number of UASTC in the data format descriptor of a KTX2 file. */
const UASTC = 166;

/** Returns what the images of a .glb are: their media type or, for KTX2, the codec and the width of level 0. */
function codecsOf(glb) {
  const length = glb.readUInt32LE(12);
  const { images, bufferViews } = JSON.parse(glb.subarray(20, 20 + length));
  const binary = glb.subarray(28 + length);
  return images
    .map(({ mimeType, bufferView }) => {
      if (mimeType !== 'image/ktx2') return mimeType;
      const ktx2 = binary.subarray(bufferViews[bufferView].byteOffset);
      const model = ktx2.readUInt8(ktx2.readUInt32LE(48) + 12);
      return `KTX2 ${model === UASTC ? 'UASTC' : model} ${ktx2.readUInt32LE(20)}`;
    })
    .sort();
}

test('has the licences beside the page', options, () => {
  for (const name of ['index.html', 'LICENSE-APACHE', 'LICENSE-MIT', 'three/LICENSE']) {
    assert.ok(existsSync(path.join(folder, NAME, name)), name);
  }
});

test('bakes a sample, shows all three pictures with errors, and offers the file that Node bakes', options, async () => {
  const page = await open();
  await finished(page);
  assert.deepEqual(modulesOf(page), ['roughcast.wasm']);
  assert.match(await status(page), /kB before, .* baked, with \d+ KTX2 textures/);
  await measured(page);
  const [before, baked, truth] = await labels(page);
  assert.deepEqual([before, baked, truth].map(({ name }) => name), ['before', 'baked', 'supersampled']);
  assert.match(await page.locator('#measured').textContent(), /about 6\.0 x 6\.0 texels\. The truth has \d+ samples/);
  // The default view is one at which bakes pay: several texels in a pixel, and light from many sides.
  assert.ok(0.01 < baked.error && baked.error < before.error && before.error < 1, `${before.error} ${baked.error}`);
  // Side by side: three columns.
  assert.equal(new Set([before, baked, truth].map(({ box }) => box.y)).size, 1);
  await page.screenshot({ path: path.join(SHOTS, 'all.png'), fullPage: true });
  const columns = await columnsOf(page);
  assert.equal(new Set(columns).size, 3, 'the three pictures differ');

  const { name, bytes } = await download(page);
  assert.equal(name, 'brushed-baked.glb');
  const sample = readFileSync(path.join(folder, NAME, 'samples/brushed.glb'));
  const settings = { engine: 'three', quality: 'fast' };
  const { document } = await bake(sample, { name: 'brushed', settings, backend: 'wasm' });
  assert.ok(bytes.equals(document.bytes), 'the bytes of the page are those of Node');
  assert.deepEqual(page.problems, []);
  assert.deepEqual([...page.hosts], [new URL(server.url).host], 'nothing leaves the machine');
});

test('bakes again with other options, without the file being opened again', options, async () => {
  const page = await open();
  await finished(page);
  assert.deepEqual(codecsOf((await download(page)).bytes), ['KTX2 UASTC 128', 'KTX2 UASTC 128', 'image/png']);

  await page.locator('#canvas').focus();
  await page.keyboard.press('+');
  await page.getByText('about 5.4 x 5.4 texels').waitFor();
  await choose(page, 'textures', 'all');
  await page.locator('#download[download="brushed-baked-all.glb"]').waitFor();
  const all = await download(page);
  assert.deepEqual(codecsOf(all.bytes), Array(3).fill('KTX2 UASTC 128'));
  assert.equal(await page.locator('#textures tr').count(), 3);
  await page.getByText('about 5.4 x 5.4 texels').waitFor();

  await choose(page, 'maxSize', '64');
  await page.locator('#download[download="brushed-baked-all-64.glb"]').waitFor();
  const small = await download(page);
  assert.deepEqual(codecsOf(small.bytes), Array(3).fill('KTX2 UASTC 64'));
  assert.ok(small.bytes.length < all.bytes.length);

  await choose(page, 'rdo', '2');
  await page.locator('#download[download="brushed-baked-all-64-rdo2.glb"]').waitFor();
  const smaller = await download(page);
  assert.ok(smaller.bytes.length < small.bytes.length);
  const kilobytes = `${(smaller.bytes.length / 1e3).toFixed(1)} kB`;
  assert.ok((await page.locator('#download').textContent()).includes(kilobytes));
  assert.ok((await status(page)).includes(`${kilobytes} baked, with 3 KTX2 textures`));
  assert.deepEqual(page.problems, []);
});

test('bakes with threads on an isolated page, to the same bytes', options, async () => {
  const page = await open({}, isolated);
  await finished(page);
  assert.equal(await page.evaluate(() => crossOriginIsolated), true);
  const processors = await page.evaluate(() => navigator.hardwareConcurrency);
  assert.deepEqual(modulesOf(page), [processors > 1 ? 'roughcast.threads.wasm' : 'roughcast.wasm']);
  const sample = readFileSync(path.join(folder, NAME, 'samples/brushed.glb'));
  const settings = { engine: 'three', quality: 'fast' };
  const { document } = await bake(sample, { name: 'brushed', settings, backend: 'wasm', threads: 1 });
  assert.ok((await download(page)).bytes.equals(document.bytes));
  // A new bake ends the one that runs, with its threads.
  for (const engine of ['babylon', 'filament']) await choose(page, 'engine', engine);
  await finished(page);
  await page.screenshot({ path: path.join(SHOTS, 'isolated.png') });
  assert.deepEqual(page.problems, []);
});

const POINTER = 'version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n';

test('takes a file, a dropped file, and says why another is refused', options, async () => {
  const page = await open();
  await finished(page);
  await openFile(page, 'lake.glb', readFileSync(path.join(fixtures, 'waves/waves.glb')));
  await page.locator('#download[download="lake-baked.glb"]').waitFor();
  // The model is first seen where a bake shows, as in the viewer.
  assert.ok(await page.locator('[name=distance][value=middle]').isChecked());
  await measured(page);
  const [plain, baked] = await labels(page);
  assert.ok(baked.error < plain.error, `${plain.error} ${baked.error}`);
  await page.evaluate(async () => {
    const bytes = await (await fetch('samples/knobs.glb')).arrayBuffer();
    const data = new DataTransfer();
    data.items.add(new File([bytes], 'stones.glb'));
    dispatchEvent(new DragEvent('drop', { dataTransfer: data }));
  });
  await page.locator('#download[download="stones-baked.glb"]').waitFor();
  await openFile(page, 'model.gltf', Buffer.from('{}'));
  await finished(page, 'failed');
  assert.match(await status(page), /model\.gltf: expected a \.glb/);
  // The page shows what has backticks as code.
  for (const [name, content, problem] of [
    ['lfs.glb', POINTER, 'a Git LFS pointer instead of the file; run git lfs pull'],
    ['empty.glb', '', 'an empty file; copy or export it again'],
    ['m.fbx', 'Kaydara FBX Binary  \0', 'a .fbx file (export the scene as glTF 2.0)'],
  ]) {
    await openFile(page, name, Buffer.from(content));
    await page.getByText(`found ${problem}`).waitFor();
    assert.ok((await status(page)).startsWith(`${name}: expected a `));
  }
  await openFile(page, 'broken.glb', Buffer.from('glTF and no more'));
  await page.waitForFunction(() => !document.getElementById('status').textContent.includes('m.fbx'));
  await finished(page, 'failed');
});

const MODULE = '**/roughcast.wasm';

/** Holds the WebAssembly module back. Returns a function that answers, by `fail` with an error. */
async function holdBake(context) {
  let end;
  const decided = new Promise((resolve) => (end = resolve));
  await context.route(MODULE, async (route) => {
    if ((await decided) === 'fail') await route.fulfill({ status: 404 });
    else await route.continue();
  });
  return end;
}

test('says above the picture what is shown while a bake runs and when it has failed', options, async () => {
  for (const [width, height, colorScheme] of [
    [1280, 800, 'light'],
    [390, 664, 'dark'],
  ]) {
    const context = await browser.newContext({ viewport: { width, height }, colorScheme });
    const page = await context.newPage();
    page.setDefaultTimeout(120_000);
    const shot = (state) => page.screenshot({ path: path.join(SHOTS, `${state}-${width}-${colorScheme}.png`) });
    const isSeen = async (selector) => {
      const box = await page.locator(selector).boundingBox();
      return box.y >= 0 && box.y + box.height <= height;
    };
    const middleIs = (text) => page.locator('[data-name=baked]', { hasText: text }).waitFor();
    const end = await holdBake(context);
    await page.goto(`${server.url}/page/index.html`);
    await page.getByText('Baking brushed.glb').waitFor();
    await middleIs(/^Baking …$/);
    assert.equal(await page.locator('progress').getAttribute('value'), null, 'no share of the work is known');
    assert.ok((await isSeen('#status')) && (await isSeen('progress')));
    await shot('busy');
    end('fail');
    await finished(page, 'failed');
    await middleIs(/^Not baked$/);
    assert.match(await status(page), /expected the WebAssembly module at .*, found 404/);
    assert.ok(await isSeen('#status'));
    await shot('failed');
    await context.unroute(MODULE);
    await choose(page, 'rdo', '2');
    await finished(page);
    await middleIs(/^Baked/);
    assert.ok((await isSeen('#status')) && /kB before/.test(await status(page)));
    await shot('done');
    await context.close();
  }
});

test('bakes a file with the options that are chosen while it loads', options, async () => {
  const page = await open();
  await finished(page);
  // Holds the images of the file back.
  await page.evaluate(() => {
    const decode = globalThis.createImageBitmap;
    const isReleased = new Promise((resolve) => (globalThis.release = resolve));
    globalThis.createImageBitmap = async (...values) => isReleased.then(() => decode(...values));
  });
  await openFile(page, 'lake.glb', readFileSync(path.join(fixtures, 'waves/waves.glb')));
  await page.getByText('Loading lake.glb').waitFor();
  await choose(page, 'maxSize', '64');
  assert.match(await status(page), /^Loading lake\.glb/);
  await page.evaluate(() => globalThis.release());
  await page.locator('#download[download="lake-baked-64.glb"]').waitFor();
  assert.deepEqual(page.problems, []);
});

test('keeps a file that is opened while a sample is fetched', options, async () => {
  const context = await browser.newContext();
  let release;
  const isReleased = new Promise((resolve) => (release = resolve));
  await context.route('**/brushed.glb', async (route) => {
    await isReleased;
    await route.continue();
  });
  const page = await context.newPage();
  page.setDefaultTimeout(120_000);
  await page.goto(`${server.url}/page/index.html`);
  await page.getByText('Loading brushed.glb').waitFor();
  await openFile(page, 'lake.glb', readFileSync(path.join(fixtures, 'waves/waves.glb')));
  await finished(page);
  const arrives = page.waitForResponse('**/brushed.glb').then((response) => response.finished());
  release();
  await arrives;
  // By then the page would show that it bakes the sample.
  await page.waitForTimeout(1000);
  assert.equal(await page.evaluate(() => document.body.dataset.state), 'done');
  assert.equal(await page.locator('#download').getAttribute('download'), 'lake-baked.glb');
  await context.close();
});

test('bakes again if another file cannot be loaded and an option has changed', options, async () => {
  const context = await browser.newContext();
  let release;
  const isReleased = new Promise((resolve) => (release = resolve));
  await context.route('**/waves.glb', async (route) => {
    await isReleased;
    await route.fulfill({ status: 404 });
  });
  const page = await context.newPage();
  page.setDefaultTimeout(120_000);
  await page.goto(`${server.url}/page/index.html`);
  await finished(page);
  await choose(page, 'sample', 'waves');
  await page.getByText('Loading waves.glb').waitFor();
  await choose(page, 'maxSize', '64');
  release();
  await page.getByText('expected the sample waves, found 404. Baking brushed.glb').waitFor();
  await page.locator('#download[download="brushed-baked-64.glb"]').waitFor();
  await finished(page, 'failed');
  assert.equal(await status(page), 'expected the sample waves, found 404');
  await context.close();
});

test('names the command that makes the file', { skip: options.skip || noBinary }, async (t) => {
  const page = await open();
  await finished(page);
  const command = () => page.locator('#command').textContent();
  assert.equal(await command(), 'npx roughcast bake brushed.glb -o brushed-baked.glb --engine three');
  await openFile(page, 'a lake.glb', readFileSync(path.join(fixtures, 'waves/waves.glb')));
  await choose(page, 'maxSize', '64');
  await page.locator('#download[download="a lake-baked-64.glb"]').waitFor();
  assert.equal(
    await command(),
    "npx roughcast bake 'a lake.glb' -o 'a lake-baked-64.glb' --engine three --max-size 64",
  );
  const cwd = temporary(t);
  writeFileSync(path.join(cwd, 'a lake.glb'), readFileSync(path.join(fixtures, 'waves/waves.glb')));
  run('sh', ['-c', (await command()).replace('npx roughcast', binary)], { cwd });
  const { name, bytes } = await download(page);
  assert.ok(bytes.equals(readFileSync(path.join(cwd, name))));
  // The notes name options as code, and errors are numbers as in the notes.
  assert.equal((await page.locator('#facts').textContent()).includes('`'), false);
  assert.match(await page.locator('#rows td').nth(2).textContent(), /^0\.\d\d$/);
});

test('scrolls with the wheel over the picture, which zooms with Ctrl or with the focus', options, async () => {
  const page = await open();
  await finished(page);
  const covers = (texels) => page.getByText(`about ${texels} x ${texels} texels`).waitFor();
  const { x, y, width, height } = await page.locator('#canvas').boundingBox();
  await page.mouse.move(x + width / 2, y + height / 2);
  await covers('6.0');
  await page.mouse.wheel(0, 100);
  await page.waitForFunction(() => scrollY > 0);
  await covers('6.0');
  await page.keyboard.down('Control');
  await page.mouse.wheel(0, 100);
  await page.keyboard.up('Control');
  await covers('6.6');
  await page.locator('#canvas').focus();
  await page.mouse.wheel(0, -100);
  await covers('6.0');
  assert.equal(await page.locator('#canvas').evaluate((canvas) => getComputedStyle(canvas).touchAction), 'pan-y');
  assert.deepEqual(page.problems, []);
});

test('follows keyboard and pointer', options, async () => {
  const page = await open();
  await finished(page);
  const split = async () => Number(await page.locator('#split').inputValue());
  assert.equal(await page.locator('#split').isVisible(), false);
  await page.locator('#canvas').focus();
  await page.keyboard.press('l');
  await page.locator('#split').waitFor();
  await page.keyboard.press(']');
  assert.equal(await split(), 550);
  const box = await page.locator('#canvas').boundingBox();
  const [x, y] = [box.x + box.width * 0.55, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x - box.width * 0.3, y, { steps: 4 });
  await page.mouse.up();
  assert.ok(Math.abs((await split()) - 250) < 5, `${await split()}`);
  await page.screenshot({ path: path.join(SHOTS, 'divider.png') });
  const picture = () => page.locator('#canvas').screenshot();
  const first = await picture();
  await page.locator('#canvas').focus();
  for (const key of ['ArrowRight', 'ArrowUp', '+', '+']) await page.keyboard.press(key);
  await page.waitForTimeout(300);
  assert.ok(!first.equals(await picture()), 'the camera moved');
  assert.deepEqual(page.problems, []);
});

test('reaches the near view by one key, and shows each shape and light', options, async () => {
  const page = await open();
  await finished(page);
  const covers = (texels) =>
    page.waitForFunction((s) => document.getElementById('measured').textContent.includes(s), `about ${texels} texels`);
  await page.locator('[name=distance]:checked').focus();
  await page.keyboard.press('ArrowLeft');
  await covers('0.5 x 0.5');
  await page.locator('#frame').screenshot({ path: path.join(SHOTS, 'near.png') });
  await page.getByText('Far', { exact: true }).click();
  await covers('24 x 24');
  for (const [name, values] of Object.entries({ kind: ['plane', 'asset'], light: ['lamp', 'room'] })) {
    for (const value of values) {
      await choose(page, name, value);
      await page.waitForTimeout(300);
      await page.locator('#frame').screenshot({ path: path.join(SHOTS, `${value}.png`) });
    }
  }
  assert.deepEqual(page.problems, []);
});

test('fits a phone, light and dark', options, async () => {
  for (const colorScheme of ['light', 'dark']) {
    const page = await open({ viewport: { width: 360, height: 740 }, colorScheme, hasTouch: true, isMobile: true });
    await finished(page);
    await measured(page);
    // One below the other.
    const boxes = (await labels(page)).map(({ box }) => box);
    assert.deepEqual([new Set(boxes.map(({ x }) => x)).size, new Set(boxes.map(({ y }) => y)).size], [1, 3]);
    for (const layout of ['divider', 'all']) {
      await choose(page, 'layout', layout);
      assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 360);
    }
    await page.screenshot({ path: path.join(SHOTS, `phone-${colorScheme}.png`), fullPage: true });
    await page.context().close();
  }
});
