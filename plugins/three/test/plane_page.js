// The page that draws a plane with the plugin, and the comparison of pictures.
import assert from 'node:assert/strict';
import path from 'node:path';
import { missing as browserMissing, launch, open } from '../browser.js';
import { serve } from '../server.js';
import { example, missing } from './roughcast.js';

/** Tests of pictures need the tool and a browser. */
export const skip = missing || browserMissing;

/**
 * The corners of the plane are at whole pixels of this view, so that GPUs do not move them. The eye sees the plane at
 * an angle of 37 degrees, from a distance of 2.4.
 */
export const VIEW = {
  size: 64,
  camera: { eye: [0, 1.44, 1.92], target: [0, 0, 0], field: (360 / Math.PI) * Math.atan(2 / 3) },
};

/** Opens the page, with `folder` at /baked/, until the end of the test. */
export async function openPictures(t, folder) {
  const served = { engines: 'engines', plugin: 'plugin', three: 'node_modules/three' };
  const folders = Object.entries(served).map(([name, at]) => [name, path.join(example, at)]);
  const server = await serve({ ...Object.fromEntries(folders), baked: folder });
  const browser = await launch();
  t.after(async () => {
    await browser.close();
    await server.close();
  });
  const page = await open(browser, `${server.url}/engines/picture.html`);
  await page.waitForFunction('window.ready');
  return page;
}

/** Returns the largest difference of a channel between a picture and the pixels of the plugin, of the brightest. */
export function difference(expected, found) {
  const [differences, values] = [[], []];
  for (const [i, channels] of expected.entries()) {
    if (!channels || found[4 * i + 3] === 0) continue;
    values.push(...channels);
    differences.push(...channels.map((value, c) => Math.abs(value - found[4 * i + c])));
  }
  assert.ok(values.length > 3 * 500, `the plane is seen: ${values.length}`);
  assert.ok(Math.max(...values) > 0.5, `the light is seen: ${Math.max(...values)}`);
  return Math.max(...differences) / Math.max(...values);
}
