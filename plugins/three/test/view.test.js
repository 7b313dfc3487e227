// The page as a person would use it. Screenshots are left in target/three.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { mkdirSync } from 'node:fs';
import path from 'node:path';
import process from 'node:process';
import test from 'node:test';
import { launch, missing as browserMissing, open } from '../browser.js';
import { example, missing, repository, roughcast, temporary } from './roughcast.js';

const SHOTS = path.join(repository, 'target/three');
const options = { skip: missing || browserMissing };

/** Runs `npm run view` with arguments. Returns its URL and standard input, or its error. */
function view(t, ...args) {
  const child = spawn(process.execPath, [path.join(example, 'view.js'), ...args]);
  t.after(() => child.kill());
  return new Promise((resolve) => {
    let complaint = '';
    child.stderr.on('data', (text) => (complaint += text));
    child.stdout.once('data', (text) => resolve({ url: String(text).trim(), input: child.stdin }));
    child.once('exit', (code) => resolve({ code, complaint }));
  });
}

async function ready(browser, url, settings) {
  const page = await open(browser, url, settings);
  await page.waitForFunction(
    () => document.documentElement.dataset.ready || /Cannot/.test(document.getElementById('status').textContent),
  );
  return page;
}

const control = (page, name) => page.locator(`#controls [name=${name}]`);

/** Returns the brightness of the picture, from its pixels. */
const brightness = async (page) => {
  const png = await page.locator('#canvas').screenshot();
  return page.evaluate(async (data) => {
    const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
    const context = Object.assign(new OffscreenCanvas(bitmap.width, bitmap.height)).getContext('2d');
    context.drawImage(bitmap, 0, 0);
    const { data: pixels } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    return pixels.reduce((sum, value, i) => sum + (i % 4 < 3 ? value : 0), 0) / pixels.length;
  }, png.toString('base64'));
};

test('shows and compares pictures and follows the keyboard', options, async (t) => {
  mkdirSync(SHOTS, { recursive: true });
  const { url, complaint } = await view(t);
  assert.ok(url?.startsWith('http://127.0.0.1:'), complaint);
  const browser = await launch();
  t.after(() => browser.close());
  const page = await ready(browser, url, { viewport: { width: 760, height: 420 } });
  const names = await control(page, 'left').locator('option').allTextContents();
  assert.deepEqual(names, ['original', 'portable', 'pyramid', 'supersampled']);
  assert.ok((await brightness(page)) > 20, 'something is seen');

  await page.locator('#canvas').focus();
  const [turn, distance, split] = [control(page, 'azimuth'), control(page, 'distance'), page.locator('#split')];
  const before = [await turn.inputValue(), await distance.inputValue(), await split.inputValue()].map(Number);
  for (const key of ['ArrowRight', '-', ']']) await page.keyboard.press(key);
  const after = [await turn.inputValue(), await distance.inputValue(), await split.inputValue()].map(Number);
  assert.deepEqual(
    after.map((value, i) => value - before[i]),
    [5, 4, 50],
  );

  await page.keyboard.press('l');
  assert.equal(await control(page, 'layout').inputValue(), 'all');
  await page.locator('#labels span').nth(3).waitFor();
  await control(page, 'subject').selectOption('sphere');
  for (const shown of ['shaded', 'normal', 'alpha', 'anisotropy', 'difference']) {
    await control(page, 'view').selectOption(shown);
    await page.waitForFunction(() =>
      /(1[6-9]|[2-9]\d|\d{3}) samples/.test(document.getElementById('status').textContent),
    );
    await page.screenshot({ path: path.join(SHOTS, `${shown}.png`) });
  }
  await control(page, 'view').selectOption('alpha');
  const auto = await brightness(page);
  await control(page, 'level').fill('7');
  await page.waitForTimeout(500);
  assert.notEqual(await brightness(page), auto, 'a level of its own');
  for (const environment of ['sky', 'none']) await control(page, 'environment').selectOption(environment);
  assert.deepEqual(page.problems, []);
});

test('fits a phone, light and dark', options, async (t) => {
  const { url } = await view(t);
  const browser = await launch();
  t.after(() => browser.close());
  for (const colorScheme of ['light', 'dark']) {
    const page = await ready(browser, url, {
      viewport: { width: 360, height: 640 },
      colorScheme,
      hasTouch: true,
      isMobile: true,
    });
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 360);
    assert.ok((await brightness(page)) > 20);
    await page.screenshot({ path: path.join(SHOTS, `phone-${colorScheme}.png`) });
    assert.deepEqual(page.problems, []);
    await page.context().close();
  }
});

test('shows an asset of the user', options, async (t) => {
  const folder = temporary(t);
  roughcast('bake', path.join(repository, 'fixtures/heights'), '-o', folder, '--profile', 'pyramid', '--quiet');
  // Files that were not named are not served.
  const { url } = await view(t, path.join(folder, 'heights.gltf'));
  for (const other of ['/asset-pyramid/../', '/asset-original/heights.gltf', '/package.json']) {
    assert.equal((await fetch(url.replace('/page/index.html', other))).status, 404);
  }
  const browser = await launch();
  t.after(() => browser.close());
  const page = await ready(browser, url, { viewport: { width: 500, height: 300 } });
  assert.deepEqual(await control(page, 'left').locator('option').allTextContents(), ['pyramid']);
  assert.deepEqual(page.problems, []);
});

test('reloads on events of a watch', options, async (t) => {
  const folder = temporary(t);
  roughcast('bake', path.join(repository, 'fixtures/waves'), '-o', folder, '--quiet');
  const { url, input } = await view(t, path.join(folder, 'waves.gltf'), '--events');
  const browser = await launch();
  t.after(() => browser.close());
  const page = await ready(browser, url, { viewport: { width: 400, height: 300 } });
  await page.evaluate(() => (window.isOld = true));
  input.write('{"event":"idle","assets":1,"failed":0}\nno JSON\n');
  await page.waitForTimeout(300);
  assert.equal(await page.evaluate(() => window.isOld), true, 'nothing is new');
  input.write('{"event":"baked","output":"waves.gltf"}\n');
  await page.waitForFunction(() => !window.isOld && document.documentElement.dataset.ready);
  assert.deepEqual(page.problems, []);
});

test('reports a file that is no asset', options, async (t) => {
  const { code, complaint } = await view(t, path.join(temporary(t), 'none.gltf'));
  assert.equal(code, 1);
  assert.match(complaint, /none\.gltf/);
});
