// What the page measures, and what it shows of that: errors, bytes, true pixels, motion.
import assert from 'node:assert/strict';
import { readFileSync, statSync } from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { launch } from '../browser.js';
import { relativeL1 } from '../looks/errors.js';
import { readable } from '../page/bytes.js';
import { MISDRAWN, isMisdrawn, readDocument, variantOf } from '../page/variants.js';
import { repository, roughcast, temporary } from './roughcast.js';
import { SHOTS, brightness, control, errors, options, pixels, ready, view } from './viewer.js';

const SCREENS = { desktop: { width: 1280, height: 800 }, phone: { width: 390, height: 844 } };
const FIXTURE = path.join(repository, 'fixtures/brushed');

/** Returns whether a condition holds within some seconds. */
async function eventually(holds) {
  for (const end = Date.now() + 20_000; Date.now() < end; ) if (await holds()) return true;
  return false;
}

test('measures errors and bytes', options, async (t) => {
  const folder = temporary(t);
  roughcast('bake', FIXTURE, '-o', folder, '--profile', 'pyramid', '--quiet');
  const baked = path.join(folder, 'brushed.gltf');
  const { url } = await view(t, baked, '--original', path.join(FIXTURE, 'brushed.gltf'));
  const browser = await launch();
  t.after(() => browser.close());
  const page = await ready(browser, url, { viewport: { width: 400, height: 300 } });
  const found = await errors(page, 256);
  assert.ok(found['Plain mips'] > 1.3 * found['Pyramid bake'], JSON.stringify(found));
  assert.match(await page.locator('#labels').innerText(), new RegExp(`error ${found['Plain mips']}`));
  const best = page.locator('#figures tr:has(.best)');
  assert.equal(await best.locator('th').innerText(), 'Pyramid bake');
  assert.match(await best.locator('.best').evaluate((cell) => getComputedStyle(cell, '::before').content), /✓/);
  assert.equal(await page.locator('.reason').count(), 0, 'the plugin draws the lobes');

  // A bake names only files that are read, except for the PNG fallbacks.
  const { buffers, images } = JSON.parse(readFileSync(baked, 'utf8'));
  const isRead = (uri) => !images.some((other) => uri !== other.uri && other.uri === uri.replace(/png$/, 'ktx2'));
  const names = ['brushed.gltf', ...[...buffers, ...images].map(({ uri }) => uri).filter(isRead)];
  const bytes = names.reduce((sum, name) => sum + statSync(path.join(folder, name)).size, 0);
  const cells = await page.locator('#figures tr').last().locator('td').allInnerTexts();
  assert.equal(cells[1], readable(bytes));
  assert.match(cells[2], /\d [kM]B/);

  const before = await brightness(page);
  await control(page, 'exposure').fill('20');
  const isBrighter = async () => (await brightness(page)) > before + 0.2;
  assert.ok(await eventually(isBrighter), 'two stops more');
  assert.deepEqual(await errors(page, 256), found, 'exposure is no part of the error');
  assert.deepEqual(page.problems, []);
});

test('sums errors on the GPU', options, async (t) => {
  const { url } = await view(t);
  const browser = await launch();
  t.after(() => browser.close());
  const page = await ready(browser, url, { viewport: { width: 300, height: 200 } });
  // No multiple of the blocks that are summed. Edges of the subject do not count.
  const [width, height, samples] = [37, 21, 3];
  const noise = (seed, i) => ((i * 7919 + seed) % 101) / 10;
  const coverage = (i) => (i % 20 === 3 ? 0.5 : 1);
  const truth = Array.from({ length: 4 * width * height }, (_, i) => (i % 4 < 3 ? noise(5, i) : coverage(i)));
  const picture = truth.map((value, i) => (i % 4 < 3 ? value + noise(17, i) - 4 : 1));
  const found = await page.evaluate(
    async (given) => {
      const [THREE, { Meter }] = [await import('three'), await import('/page/measure.js')];
      const float = (data) =>
        Object.assign(
          new THREE.DataTexture(Float32Array.from(data), given.width, given.height, THREE.RGBAFormat, THREE.FloatType),
          { needsUpdate: true },
        );
      return new Meter(new THREE.WebGLRenderer()).relativeL1(
        { texture: float(given.picture), samples: 1 },
        { texture: float(given.truth.map((value) => given.samples * value)), samples: given.samples },
      );
    },
    { picture, truth, samples, width, height },
  );
  const inside = (values) => values.map((value, i) => (truth[i | 3] < 0.999 ? 0 : value));
  assert.ok(Math.abs(found / relativeL1(inside(picture), inside(truth)) - 1) < 1e-4, `${found}`);
  assert.deepEqual(page.problems, []);
});

test('magnifies true pixels of all variants', options, async (t) => {
  const { url } = await view(t);
  const browser = await launch();
  t.after(() => browser.close());
  const page = await ready(browser, url, { viewport: { width: 900, height: 420 } });
  await errors(page);
  await page.mouse.move(285, 180);
  await page.locator('#canvas').focus();
  await page.keyboard.press('m');
  await page.locator('#tiles span').nth(3).waitFor();
  const tile = await page.locator('#tiles span').first().boundingBox();
  await page.addStyleTag({ content: '#frame > :not(canvas) { visibility: hidden; }' });
  const [clip, side] = [{ ...tile, width: 64, height: 64 }, 64];
  // Rows count from the bottom of a tile.
  clip.y = tile.y + tile.height - side;
  const shown = await pixels(page, clip);
  const colours = new Set();
  for (let y = 0; y < side; y++) {
    for (let x = 0; x < side; x++) {
      const [at, first] = [4 * (y * side + x), 4 * ((y - (y % 8)) * side + x - (x % 8))];
      assert.deepEqual(shown.slice(at, at + 3), shown.slice(first, first + 3), `pixel ${x}, ${y}`);
      colours.add(shown.slice(at, at + 3).join());
    }
  }
  assert.ok(colours.size > 8, `${colours.size} colours`);
  await page.keyboard.press('m');
  await page.locator('#tiles').waitFor({ state: 'hidden' });
  assert.deepEqual(page.problems, []);
});

test('turns unless less motion is wanted', options, async (t) => {
  const { url } = await view(t);
  const browser = await launch();
  t.after(() => browser.close());
  const viewport = { width: 300, height: 300 };
  const isTurning = (page) => page.locator('#play[aria-pressed=true]').count();
  const still = await ready(browser, url, { viewport });
  await errors(still, 256);
  assert.equal(await isTurning(still), 0);
  await still.context().close();

  const page = await ready(browser, url, { viewport, reducedMotion: 'no-preference' });
  await page.locator('#play[aria-pressed=true]').waitFor();
  // The asset is nearly a solid of revolution.
  await control(page, 'subject').selectOption('plane');
  await page.waitForTimeout(500);
  await page.addStyleTag({ content: '#labels, #status { visibility: hidden; }' });
  const first = (await pixels(page)).join();
  assert.ok(await eventually(async () => (await pixels(page)).join() !== first), 'the subject moves');
  await page.locator('#canvas').focus();
  await page.keyboard.press(' ');
  assert.equal(await isTurning(page), 0);
  // At rest the errors of the new picture are measured.
  await errors(page);
  assert.deepEqual(page.problems, []);
});

test('tells variants by their documents', () => {
  const json = JSON.stringify({ asset: { version: '2.0', extras: { roughcast: {} } } });
  const padded = json.padEnd(Math.ceil(json.length / 4) * 4);
  const header = Buffer.alloc(20);
  header.write('glTF');
  header.writeUInt32LE(padded.length, 12);
  const glb = new Uint8Array(Buffer.concat([Buffer.from([0, 0, 0]), header, Buffer.from(padded)])).subarray(3);
  assert.equal(variantOf(readDocument(glb)), 'portable');
  assert.equal(variantOf({ asset: { version: '2.0' } }), 'original');
  assert.equal(variantOf({ extensionsUsed: ['ROUGHCAST_materials_roughness_pyramid'] }), 'pyramid');
  assert.throws(() => readDocument(Buffer.from('no JSON')), SyntaxError);
});

test('tells bakes that three.js draws wrongly', () => {
  const bake = (anisotropyTexture, more) => ({
    asset: { extras: { roughcast: {} } },
    materials: [{}, { extensions: { KHR_materials_anisotropy: { anisotropyTexture } } }],
    textures: [{ source: 0 }, { extensions: { KHR_texture_basisu: { source: 1 } } }],
    ...more,
  });
  assert.equal(isMisdrawn(bake({ index: 1 })), true);
  assert.equal(isMisdrawn(bake({ index: 0 })), false, 'a texture of the source');
  assert.equal(isMisdrawn(bake(undefined)), false, 'the anisotropy of the source');
  assert.equal(isMisdrawn(bake({ index: 1 }, { asset: {} })), false, 'an original');
  const extensionsUsed = ['ROUGHCAST_materials_roughness_pyramid'];
  assert.equal(isMisdrawn(bake({ index: 1 }, { extensionsUsed })), false, 'the plugin draws it');
  assert.equal(isMisdrawn({ asset: { extras: { roughcast: {} } } }), false, 'no materials');
});

test('explains a bake that three.js draws wrongly, and the colours of differences', options, async (t) => {
  const folder = temporary(t);
  const baked = path.join(folder, 'brushed.glb');
  roughcast('bake', path.join(FIXTURE, 'brushed.gltf'), '-o', baked, '--quiet');
  const { url } = await view(t, baked, '--original', path.join(FIXTURE, 'brushed.gltf'));
  const browser = await launch();
  t.after(() => browser.close());
  for (const [name, viewport] of Object.entries(SCREENS)) {
    for (const colorScheme of ['light', 'dark']) {
      const page = await ready(browser, url, { viewport, colorScheme });
      await errors(page);
      assert.deepEqual(await page.locator('.reason').allInnerTexts(), [MISDRAWN]);
      assert.equal(await page.locator('#figures tr').nth(2).innerText(), MISDRAWN, 'below the bake');
      assert.equal(await control(page, 'subject').inputValue(), 'sphere');
      assert.match(await page.locator('#footprint').textContent(), /about 6\.0 x 6\.0 texels.*on a sphere/);
      await page.screenshot({ path: path.join(SHOTS, `reason-${name}-${colorScheme}.png`) });

      const scale = page.locator('#scale');
      assert.equal(await scale.isVisible(), false);
      await control(page, 'view').selectOption('difference');
      await scale.waitFor();
      assert.deepEqual(await scale.locator('span').allInnerTexts(), ['0', '0.05', '0.25', '0.5', '1']);
      assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), viewport.width);
      await page.screenshot({ path: path.join(SHOTS, `scale-${name}-${colorScheme}.png`) });
      // The asset itself can still be chosen.
      await control(page, 'subject').selectOption('asset');
      await page.getByText('Few bumps are lost so near').waitFor();
      assert.deepEqual(page.problems, []);
      await page.context().close();
    }
  }
});

test('the scale has the colours of the view', options, async (t) => {
  const { url } = await view(t);
  const browser = await launch();
  t.after(() => browser.close());
  const page = await ready(browser, url, { viewport: { width: 300, height: 200 } });
  const drawn = await page.evaluate(async () => {
    const [THREE, { RAMP, gradient }] = [await import('three'), await import('/page/ramp.js')];
    const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true });
    renderer.setSize(256, 1);
    const material = new THREE.ShaderMaterial({
      vertexShader: 'void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }',
      fragmentShader: `${RAMP} void main() { gl_FragColor = vec4(ramp(pow(gl_FragCoord.x / 256.0, 2.0)), 1.0); }`,
    });
    const quad = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), material);
    quad.frustumCulled = false;
    renderer.render(quad, new THREE.Camera());
    const context = new OffscreenCanvas(256, 1).getContext('2d');
    context.drawImage(renderer.domElement, 0, 0);
    const bar = Object.assign(document.createElement('div'), { id: 'bar' });
    bar.style = 'position: fixed; z-index: 9; inset: 0 auto auto 0; width: 256px; height: 1px';
    bar.style.background = gradient();
    document.body.append(bar);
    return [...context.getImageData(0, 0, 256, 1).data];
  });
  const shown = await pixels(page, { x: 0, y: 0, width: 256, height: 1 });
  for (const [i, value] of drawn.entries()) {
    // Browsers place the stops of a gradient within a pixel.
    assert.ok(Math.abs(value - shown[i]) < 8, `place ${i >> 2}, channel ${i % 4}: ${value} ${shown[i]}`);
  }
  assert.deepEqual(page.problems, []);
});

test('writes bytes for people', () => {
  assert.deepEqual(
    [0, 999, 1000, 12_345, 999_499, 1_400_000, 123_456_789].map(readable),
    ['0 B', '999 B', '1.0 kB', '12 kB', '999 kB', '1.4 MB', '123 MB'],
  );
});
