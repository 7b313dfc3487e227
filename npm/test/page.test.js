// The try-it page as a person would use it, in headless Chromium. Screenshots are left in target/npm.
import assert from 'node:assert/strict';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import process from 'node:process';
import test, { after, before } from 'node:test';
import { chromium } from 'playwright-core';
import { bake } from 'roughcast';
import { serve } from '../../plugins/three/server.js';
import { fixtures, noModule, npm, repository, run } from './common.js';

const executablePath = process.env.CHROMIUM ?? '/usr/bin/chromium';
const noBrowser = existsSync(executablePath) ? false : `needs Chromium at ${executablePath} (or $CHROMIUM)`;
const options = { skip: noModule || noBrowser };
const SHOTS = path.join(repository, 'target/npm');
const ARGUMENTS = ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic'];

let folder;
let server;
let isolated;
let browser;

before(async () => {
  if (options.skip) return;
  mkdirSync(SHOTS, { recursive: true });
  folder = mkdtempSync(path.join(os.tmpdir(), 'roughcast-page-'));
  run(process.execPath, [path.join(npm, 'make-page.js'), '--out', path.join(folder, 'page')]);
  server = await serve({ page: path.join(folder, 'page') });
  isolated = await serve({ page: path.join(folder, 'page') }, { isIsolated: true });
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

test('bakes a sample, shows the truth, and offers the file that Node bakes', options, async () => {
  const page = await open();
  await finished(page);
  assert.deepEqual(modulesOf(page), ['roughcast.wasm']);
  assert.match(await status(page), /kB before, .* baked, with \d+ KTX2 textures/);
  await page.screenshot({ path: path.join(SHOTS, 'before-baked.png'), fullPage: true });

  await choose(page, 'right', 'supersampled');
  await page.waitForFunction(() =>
    /(3[2-9]|[4-9]\d|\d{3}) samples/.test(document.getElementById('samples').textContent),
  );
  const measured = /error: before (\S+), baked (\S+)/.exec(await page.locator('#samples').textContent());
  for (const error of measured.slice(1)) assert.ok(0.01 < Number(error) && Number(error) < 0.5, measured[0]);
  await page.screenshot({ path: path.join(SHOTS, 'before-truth.png') });
  await choose(page, 'left', 'baked');
  await page.screenshot({ path: path.join(SHOTS, 'baked-truth.png') });

  const { name, bytes } = await download(page);
  assert.equal(name, 'brushed.baked.glb');
  const sample = readFileSync(path.join(folder, 'page/samples/brushed.glb'));
  const settings = { engine: 'three', quality: 'fast', gltf: 'strict' };
  const { document } = await bake(sample, { name: 'brushed', settings, backend: 'wasm' });
  assert.ok(bytes.equals(document.bytes), 'the bytes of the page are those of Node');
  assert.deepEqual(page.problems, []);
  assert.deepEqual([...page.hosts], [new URL(server.url).host], 'nothing leaves the machine');
});

test('bakes with threads on an isolated page, to the same bytes', options, async () => {
  const page = await open({}, isolated);
  await finished(page);
  assert.equal(await page.evaluate(() => crossOriginIsolated), true);
  const processors = await page.evaluate(() => navigator.hardwareConcurrency);
  assert.deepEqual(modulesOf(page), [processors > 1 ? 'roughcast.threads.wasm' : 'roughcast.wasm']);
  const sample = readFileSync(path.join(folder, 'page/samples/brushed.glb'));
  const settings = { engine: 'three', quality: 'fast', gltf: 'strict' };
  const { document } = await bake(sample, { name: 'brushed', settings, backend: 'wasm', threads: 1 });
  assert.ok((await download(page)).bytes.equals(document.bytes));
  // A new bake ends the one that runs, with its threads.
  for (const engine of ['babylon', 'filament']) await choose(page, 'engine', engine);
  await finished(page);
  await page.screenshot({ path: path.join(SHOTS, 'isolated.png') });
  assert.deepEqual(page.problems, []);
});

test('takes a file, a dropped file, and says why another is refused', options, async () => {
  const page = await open();
  await finished(page);
  await openFile(page, 'lake.glb', readFileSync(path.join(fixtures, 'waves/waves.glb')));
  await page.locator('#download[download="lake.baked.glb"]').waitFor();
  await page.evaluate(async () => {
    const bytes = await (await fetch('samples/knobs.glb')).arrayBuffer();
    const data = new DataTransfer();
    data.items.add(new File([bytes], 'stones.glb'));
    dispatchEvent(new DragEvent('drop', { dataTransfer: data }));
  });
  await page.locator('#download[download="stones.baked.glb"]').waitFor();
  await openFile(page, 'model.gltf', Buffer.from('{}'));
  await finished(page, 'failed');
  assert.match(await status(page), /model\.gltf: expected a \.glb/);
  await openFile(page, 'broken.glb', Buffer.from('glTF and no more'));
  await page.waitForFunction(() => !document.getElementById('status').textContent.includes('model.gltf'));
  await finished(page, 'failed');
});

test('follows keyboard and pointer', options, async () => {
  const page = await open();
  await finished(page);
  const split = async () => Number(await page.locator('#split').inputValue());
  await page.locator('#canvas').focus();
  await page.keyboard.press(']');
  assert.equal(await split(), 550);
  const box = await page.locator('#canvas').boundingBox();
  const [x, y] = [box.x + box.width * 0.55, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x - box.width * 0.3, y, { steps: 4 });
  await page.mouse.up();
  assert.ok(Math.abs((await split()) - 250) < 5, `${await split()}`);
  const picture = () => page.locator('#canvas').screenshot();
  const first = await picture();
  await page.locator('#canvas').focus();
  for (const key of ['ArrowRight', 'ArrowUp', '+', '+']) await page.keyboard.press(key);
  await page.waitForTimeout(300);
  assert.ok(!first.equals(await picture()), 'the camera moved');
  for (const kind of ['asset', 'sphere']) {
    await choose(page, 'kind', kind);
    await page.waitForTimeout(300);
    await page.locator('#frame').screenshot({ path: path.join(SHOTS, `${kind}.png`) });
  }
  assert.deepEqual(page.problems, []);
});

test('fits a phone, light and dark', options, async () => {
  for (const colorScheme of ['light', 'dark']) {
    const page = await open({ viewport: { width: 360, height: 740 }, colorScheme, hasTouch: true, isMobile: true });
    await finished(page);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 360);
    await page.screenshot({ path: path.join(SHOTS, `phone-${colorScheme}.png`), fullPage: true });
    await page.context().close();
  }
});
