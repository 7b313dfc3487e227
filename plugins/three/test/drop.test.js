// Files of a person: dropped or chosen, and with compressed geometry.
import assert from 'node:assert/strict';
import { copyFileSync, mkdirSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { launch } from '../browser.js';
import { withDraco, withMeshopt } from './compress.js';
import { repository, roughcast, temporary } from './roughcast.js';
import { control, errors, options, pixels, ready, view } from './viewer.js';

const FIXTURE = path.join(repository, 'fixtures/brushed');
const VIEWPORT = { width: 400, height: 300 };
const titles = (page) => control(page, 'left').locator('option').allTextContents();
const files = (folder) => readdirSync(folder).map((name) => path.join(folder, name));

/** Drops files on the page. */
const drop = (page, contents) =>
  page.evaluate((given) => {
    const dataTransfer = new DataTransfer();
    for (const [name, bytes] of given) dataTransfer.items.add(new File([Uint8Array.from(bytes)], name));
    const event = { dataTransfer, bubbles: true, cancelable: true };
    for (const type of ['dragenter', 'dragover', 'drop'])
      document.getElementById('frame').dispatchEvent(new DragEvent(type, event));
  }, contents);

test('shows files that are dropped or chosen', options, async (t) => {
  const folder = temporary(t);
  roughcast('bake', path.join(repository, 'fixtures/waves'), '-o', folder, '--profile', 'pyramid', '--quiet');
  const { url } = await view(t);
  const browser = await launch();
  t.after(() => browser.close());
  const page = await ready(browser, url, { viewport: VIEWPORT });
  assert.equal((await titles(page)).length, 4);

  const waves = readFileSync(path.join(repository, 'fixtures/waves/waves.glb'));
  await drop(page, [['waves.glb', [...waves]]]);
  await page.waitForFunction(() => document.querySelectorAll('#figures tr').length === 1);
  assert.deepEqual(await titles(page), ['Plain mips', 'Supersampled'], 'an original replaces everything');
  await errors(page);

  await page.locator('#files').setInputFiles(path.join(FIXTURE, 'brushed.gltf'));
  const problem = page.locator('#problem:not(:empty)');
  await problem.waitFor();
  assert.match(await problem.textContent(), /brushed\.gltf needs .*brushed\.bin.*drop/);
  assert.deepEqual(await titles(page), ['Plain mips', 'Supersampled'], 'what was shown stays');

  await page.locator('#files').setInputFiles(files(FIXTURE));
  await page.waitForFunction(() => !document.getElementById('problem').textContent);
  await drop(page, [['notes.txt', [1]]]);
  assert.match(await problem.textContent(), /drop one with all its files/);
  const says = (text) =>
    page.waitForFunction((part) => document.getElementById('problem').textContent.includes(part), text);
  await drop(page, [['broken.gltf', [...Buffer.from('{')]]]);
  await says('broken.gltf is no glTF');
  await drop(page, [['lfs.glb', [...Buffer.from('version https://git-lfs.github.com/spec/v1\n')]]]);
  await says('lfs.glb: expected a glTF document, found a Git LFS pointer instead of the file; run `git lfs pull`');
  await drop(page, [['m.fbx', [1]]]);
  await says('m.fbx: expected a .gltf or .glb file, found a .fbx file (export the scene as glTF 2.0)');
  await drop(page, [
    ['a.glb', [...waves]],
    ['b.glb', [...waves]],
  ]);
  await says('a.glb and b.glb');
  const expected = /Couldn't load texture brushed_/;
  assert.deepEqual(
    page.problems.filter((text) => !expected.test(text)),
    [],
  );
});

test('shows what was dropped last, however long the files before take', options, async (t) => {
  const { url } = await view(t, path.join(repository, 'fixtures/waves/waves.glb'));
  const browser = await launch();
  t.after(() => browser.close());
  const page = await ready(browser, url, { viewport: VIEWPORT });
  await page.evaluate(() => {
    const figures = document.getElementById('figures');
    const bytes = () => figures.querySelector('td:last-child').textContent;
    window.sizes = [bytes()];
    // Errors change the table, too.
    const note = () => bytes() !== window.sizes.at(-1) && window.sizes.push(bytes());
    new MutationObserver(note).observe(figures, { childList: true });
    // The first image takes long.
    const { createImageBitmap } = window;
    window.createImageBitmap = async (...given) => {
      window.createImageBitmap = createImageBitmap;
      await new Promise((resolve) => setTimeout(resolve, 1000));
      return createImageBitmap(...given);
    };
  });
  const contents = (names) => names.map((name) => [path.basename(name), [...readFileSync(name)]]);
  await drop(page, contents(files(FIXTURE)));
  await drop(page, contents([path.join(repository, 'fixtures/waves/waves.glb')]));
  await page.waitForFunction(() => window.sizes.length === 3);
  const [first, , last] = await page.evaluate(() => window.sizes);
  assert.equal(last, first);
  assert.deepEqual(page.problems, []);
});

test('adds a dropped bake to its original', options, async (t) => {
  const folder = temporary(t);
  roughcast('bake', FIXTURE, '-o', folder, '--gltf', 'strict', '--quiet');
  const { url } = await view(t, path.join(FIXTURE, 'brushed.gltf'));
  const browser = await launch();
  t.after(() => browser.close());
  const page = await ready(browser, url, { viewport: VIEWPORT });
  assert.deepEqual(await titles(page), ['Plain mips', 'Supersampled']);
  // A browser gives folders to a drop only; chosen files have no folders.
  const document = JSON.parse(readFileSync(path.join(folder, 'brushed.gltf'), 'utf8'));
  const chosen = path.join(folder, 'chosen');
  mkdirSync(chosen);
  for (const named of [...document.buffers, ...document.images]) {
    copyFileSync(path.join(folder, named.uri), path.join(chosen, path.basename(named.uri)));
    named.uri = path.basename(named.uri);
  }
  writeFileSync(path.join(chosen, 'brushed.gltf'), JSON.stringify(document));
  await page.locator('#files').setInputFiles(files(chosen));
  await page.waitForFunction(() => document.querySelectorAll('#figures tr:not(.reason)').length === 2);
  assert.deepEqual(await titles(page), ['Plain mips', 'Portable bake', 'Supersampled']);
  assert.deepEqual(page.problems, []);
});

test('decodes geometry of Draco and meshoptimizer', options, async (t) => {
  const folder = temporary(t);
  const gltf = JSON.parse(readFileSync(path.join(FIXTURE, 'brushed.gltf'), 'utf8'));
  const bin = readFileSync(path.join(FIXTURE, 'brushed.bin'));
  for (const { uri } of gltf.images) copyFileSync(path.join(FIXTURE, uri), path.join(folder, uri));
  writeFileSync(path.join(folder, 'draco.gltf'), JSON.stringify(await withDraco(gltf, bin)));
  writeFileSync(path.join(folder, 'meshopt.gltf'), JSON.stringify(await withMeshopt(gltf, bin)));
  const browser = await launch();
  t.after(() => browser.close());
  const shown = [];
  const compressed = ['draco.gltf', 'meshopt.gltf'].map((name) => path.join(folder, name));
  for (const file of [path.join(FIXTURE, 'brushed.gltf'), ...compressed]) {
    const { url } = await view(t, file);
    const page = await ready(browser, url, { viewport: VIEWPORT });
    assert.deepEqual(await titles(page), ['Plain mips', 'Supersampled'], file);
    // The page shows the maps on a sphere at first.
    await page.locator('#controls [name=subject]').selectOption('asset');
    await page.locator('#divider').press('End');
    await page.waitForTimeout(500);
    await page.addStyleTag({ content: '#frame > :not(canvas) { visibility: hidden; }' });
    shown.push(await pixels(page));
    assert.deepEqual(page.problems, []);
    await page.context().close();
  }
  const [plain, ...others] = shown;
  for (const other of others) {
    const off = plain.reduce((sum, value, i) => sum + Math.abs(value - other[i]), 0) / plain.length;
    assert.ok(off < 1, `${off} of 255`);
  }
});
