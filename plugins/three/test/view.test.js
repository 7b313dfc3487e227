// The page as a person would use it. Screenshots are left in target/three.
import assert from 'node:assert/strict';
import { mkdirSync } from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { launch } from '../browser.js';
import { repository, roughcast, temporary } from './roughcast.js';
import { SHOTS, brightness, control, errors, options, ready, view } from './viewer.js';

/** Returns the place of the divider, in percent. */
const place = async (page) => Number(await page.locator('#divider').getAttribute('aria-valuenow'));

test('shows and compares pictures and follows the keyboard', options, async (t) => {
  mkdirSync(SHOTS, { recursive: true });
  const { url, complaint } = await view(t);
  assert.ok(url?.startsWith('http://127.0.0.1:'), complaint);
  const browser = await launch();
  t.after(() => browser.close());
  const page = await ready(browser, url, { viewport: { width: 760, height: 420 } });
  const names = await control(page, 'left').locator('option').allTextContents();
  assert.deepEqual(names, ['Plain mips', 'Portable bake', 'Pyramid bake', 'Supersampled']);
  assert.ok((await brightness(page)) > 20, 'something is seen');

  await page.locator('#canvas').focus();
  const [turn, distance] = [control(page, 'azimuth'), control(page, 'distance')];
  const state = async () => [Number(await turn.inputValue()), Number(await distance.inputValue()), await place(page)];
  const before = await state();
  for (const key of ['ArrowRight', '-', ']']) await page.keyboard.press(key);
  const after = await state();
  assert.deepEqual(
    after.map((value, i) => value - before[i]),
    [5, 4, 5],
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

test('shows a bake at first, and says where an asset has too few texels for that', options, async (t) => {
  const { url } = await view(t);
  const browser = await launch();
  t.after(() => browser.close());
  const page = await ready(browser, url, { viewport: { width: 760, height: 200 } });
  const footprint = page.locator('#footprint');
  assert.match(await footprint.textContent(), /about (5\.[5-9]|6\.[0-5]) x/);
  const found = await errors(page);
  assert.ok(found['Plain mips'] > 1.2 * found['Portable bake'], JSON.stringify(found));

  await control(page, 'subject').selectOption('asset');
  await page.getByText(/about 1\.[45] x/).waitFor();
  const shown = () => control(page, 'distance').locator('xpath=../output').textContent();
  assert.equal(await shown(), '7.8');
  await control(page, 'distance').fill('0');
  await page.getByText('Few bumps are lost so near').waitFor();
  // Another layout leaves the camera where it is.
  await control(page, 'layout').selectOption('all');
  assert.equal(await shown(), '2.2');
  assert.deepEqual(page.problems, []);
});

test('drags the divider on the picture', options, async (t) => {
  const { url } = await view(t);
  const browser = await launch();
  t.after(() => browser.close());
  const page = await ready(browser, url, { viewport: { width: 760, height: 420 } });
  const { x, y, width, height } = await page.locator('#frame').boundingBox();
  const at = (share) => [x + share * width, y + 0.3 * height];
  const turn = await control(page, 'azimuth').inputValue();
  await page.mouse.move(...at(0.5));
  await page.mouse.down();
  await page.mouse.move(...at(0.25));
  await page.mouse.up();
  assert.equal(await place(page), 25);
  assert.equal(await control(page, 'azimuth').inputValue(), turn, 'the camera stays');
  for (const [key, wanted] of Object.entries({ ArrowRight: 26, PageUp: 36, End: 100, Home: 0 })) {
    await page.keyboard.press(key);
    assert.equal(await place(page), wanted, key);
  }
  await page.mouse.move(...at(0.5));
  await page.mouse.down();
  await page.mouse.move(...at(0.6));
  assert.notEqual(await control(page, 'azimuth').inputValue(), turn, 'beside the divider, the camera turns');
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
  assert.deepEqual(await control(page, 'left').locator('option').allTextContents(), ['Pyramid bake']);
  assert.match(await page.locator('#note').textContent(), /need the original/);
  assert.deepEqual(page.problems, []);
});

test('reloads on events of a watch', options, async (t) => {
  const folder = temporary(t);
  roughcast('bake', path.join(repository, 'fixtures/waves'), '-o', folder, '--quiet');
  const { url, input } = await view(t, path.join(folder, 'waves.glb'), '--events');
  const browser = await launch();
  t.after(() => browser.close());
  const page = await ready(browser, url, { viewport: { width: 400, height: 300 } });
  await page.evaluate(() => (window.isOld = true));
  input.write('{"event":"idle","assets":1,"failed":0}\nno JSON\n');
  await page.waitForTimeout(300);
  assert.equal(await page.evaluate(() => window.isOld), true, 'nothing is new');
  input.write('{"event":"baked","output":"waves.glb"}\n');
  await page.waitForFunction(() => !window.isOld && document.documentElement.dataset.ready);
  assert.deepEqual(page.problems, []);
});

test('reports a file that is no asset', options, async (t) => {
  const { code, complaint } = await view(t, path.join(temporary(t), 'none.gltf'));
  assert.equal(code, 1);
  assert.match(complaint, /none\.gltf/);
});
