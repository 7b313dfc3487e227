// The page in a browser, as tests use it.
import { spawn } from 'node:child_process';
import path from 'node:path';
import process from 'node:process';
import { missing as browserMissing, open } from '../browser.js';
import { example, missing, repository } from './roughcast.js';

/** Where screenshots are left. */
export const SHOTS = path.join(repository, 'target/three');
/** Tests of the page need the tool and a browser. */
export const options = { skip: missing || browserMissing };

/** Runs `npm run view` with arguments. Returns its URL and standard input, or its error. */
export function view(t, ...args) {
  const child = spawn(process.execPath, [path.join(example, 'view.js'), ...args]);
  t.after(() => child.kill());
  return new Promise((resolve) => {
    let complaint = '';
    child.stderr.on('data', (text) => (complaint += text));
    child.stdout.once('data', (text) => resolve({ url: String(text).trim(), input: child.stdin }));
    child.once('exit', (code) => resolve({ code, complaint }));
  });
}

/** Opens the page, without motion unless `settings` asks for it, and waits until it shows something. */
export async function ready(browser, url, settings) {
  const page = await open(browser, url, { reducedMotion: 'reduce', ...settings });
  await page.waitForFunction(
    () => document.documentElement.dataset.ready || document.getElementById('problem').textContent,
  );
  return page;
}

/** Returns a control of the form by its name. */
export const control = (page, name) => page.locator(`#controls [name=${name}]`);

/** Waits until errors are measured against at least `samples` samples per pixel. Returns them in percent, by title. */
export async function errors(page, samples = 16) {
  await page.waitForFunction((least) => {
    const [, count] = document.getElementById('note').textContent.match(/of this picture against (\d+) samples/) ?? [];
    return Number(count) >= least;
  }, samples);
  const rows = await page.locator('#figures tr:not(.reason)').allInnerTexts();
  return Object.fromEntries(rows.map((row) => row.split('\t')).map(([title, error]) => [title, parseFloat(error)]));
}

/** Returns the pixels of a part of the canvas as displayed: RGBA, row by row from the top. */
export async function pixels(page, clip) {
  const box = await page.locator('#canvas').boundingBox();
  const png = await page.screenshot({ clip: clip ?? box });
  return page.evaluate(async (data) => {
    const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
    context.drawImage(bitmap, 0, 0);
    return [...context.getImageData(0, 0, bitmap.width, bitmap.height).data];
  }, png.toString('base64'));
}

/** Returns the brightness of the picture, from its pixels. */
export async function brightness(page) {
  const values = await pixels(page);
  return values.reduce((sum, value, i) => sum + (i % 4 < 3 ? value : 0), 0) / values.length;
}
