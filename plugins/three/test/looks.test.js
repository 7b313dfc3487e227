// From 1 sample per pixel, what is baked is closer to the truth than plain mips. docs/engines.md has the whole table.
import assert from 'node:assert/strict';
import test from 'node:test';
import { missing as browserMissing } from '../browser.js';
import { flicker, relativeL1, ssim } from '../looks/errors.js';
import { DISTANCES, forEach, materials } from '../looks/run.js';
import { PARTS, errorOf, share, tables } from '../looks/table.js';
import { missing, temporary } from './roughcast.js';

/** Names of the variants in the page. */
const NAMED = ['original', 'portable', 'reflected', 'pyramid'];

test('bakes are closer to the truth than plain mips are', { skip: missing || browserMissing }, async (t) => {
  const folder = temporary(t);
  const [fixture] = materials(folder);
  await forEach(folder, [fixture], async (_, page) => {
    const errors = async (kind, names) => {
      const all = [];
      for (const distance of DISTANCES) {
        all.push(await page.evaluate((o) => window.errors(o), { kind, distance, size: 64, samples: 64, names }));
      }
      return all.map((variants) => variants.map(([l1]) => l1));
    };
    const [plane, sphere] = [await errors('plane'), await errors('sphere')];
    const total = (all, i) => all.reduce((sum, variants) => sum + variants[i], 0);
    for (const [i, [plain, , reflected, pyramid]] of plane.entries()) {
      // `portable` alone would fail: an isotropic lobe is wrong for light from across the grooves.
      assert.ok(Math.max(reflected, pyramid) < plain, `plane at ${DISTANCES[i]}: ${plane[i]}`);
    }
    // At the first distance each bump is visible, so no bumps are lost.
    for (const [i, [plain, anisotropic]] of (await errors('plane', ['original', 'anisotropic'])).entries()) {
      assert.ok(
        i === 0 || anisotropic < plain,
        `anisotropic without the plugin, plane at ${DISTANCES[i]}: ${anisotropic} of ${plain}`,
      );
    }
    for (const [i, [plain, , reflected, pyramid]] of sphere.entries()) {
      assert.ok(Math.max(reflected, pyramid) < plain, `sphere at ${DISTANCES[i]}: ${sphere[i]}`);
    }
    for (const all of [plane, sphere])
      assert.ok(total(all, 0) > 1.8 * Math.max(total(all, 2), total(all, 3)), `${all}`);
    assert.ok(total(sphere, 0) > 1.3 * total(sphere, 1), `${sphere}`);
    // The grooves have one direction. Whether an isotropic lobe gains under a single light depends on where it stands.
    const lights = Array.from({ length: 12 }, (_, i) => ({ azimuth: 30 * i, elevation: i % 2 === 0 ? 55 : 25 }));
    for (const [kind, level] of [
      ['plane', 2.5],
      ['plane', 5.5],
      ['sphere', 2.5],
      ['sphere', 5.5],
    ]) {
      const view = { kind, level, size: 32, samples: 144, lights };
      const truth = `data:;base64,${await page.evaluate((o) => window.truths(o), view)}`;
      const gains = await page.evaluate((o) => window.gains(o), { view, names: NAMED, truth });
      const [plain, portable, ...shaded] = NAMED.map((name) => gains[name].both);
      const told = `${kind} at level ${level}, under lights from all around: ${plain}, ${portable}, ${shaded}`;
      assert.ok(plain > 1.4 * portable && plain > 2 * Math.max(...shaded), told);
      assert.ok(gains.original.suns > gains.pyramid.suns && gains.original.environment > gains.pyramid.environment);
    }
    const [plain, , reflected, pyramid] = await page.evaluate((o) => window.flicker(o), {
      kind: 'plane',
      distance: 12,
      size: 48,
      samples: 64,
      frames: 6,
    });
    assert.ok(Math.max(reflected, pyramid) < plain, `flicker: ${reflected}, ${pyramid} of ${plain}`);
    const apart = (...names) => page.evaluate((o) => window.apart(o), { kind: 'sphere', distance: 5, size: 64, names });
    // Occlusion shares a texture with the roughness mips, so the occlusion of `both` has been encoded.
    assert.ok((await apart('both', 'pyramid')) < 0.02, 'K is counted once where the core material has it, too');
    assert.ok((await apart('portable', 'pyramid')) > 0.1);
    assert.deepEqual(page.problems, []);
  });
});

const grey = (values) => Float32Array.from(values.flatMap((v) => [v, v, v, 1]));

test('computes errors of hand-made pictures', () => {
  const [a, b] = [grey([1, 2, 1, 0]), grey([2, 2, 0, 0])];
  assert.equal(relativeL1(a, b), 0.5);
  assert.equal(relativeL1(b, b), 0);
  const [noise, flat] = [Array.from({ length: 256 }, (_, i) => (i * 7919) % 13), Array(256).fill(6)].map(grey);
  assert.ok(Math.abs(ssim(noise, noise, 16) - 1) < 1e-12);
  assert.ok(ssim(flat, noise, 16) < 0.3);
  // A constant error is no flicker.
  assert.equal(flicker([grey([1, 1]), grey([1, 1])], [grey([2, 2]), grey([2, 2])]), 0);
  assert.ok(flicker([grey([1, 2]), grey([2, 1])], [grey([1, 1]), grey([1, 1])]) > 0.001);
});

test('computes shares of the reachable gain', () => {
  assert.equal(share(0.5, 0.3, 0.1), 0.5);
  assert.equal(share(0.5, 0.4, 0.499), null, 'where nothing can be gained, there is no share');
  const view = (error) => ({ both: error, suns: 2 * error, environment: error / 2 });
  const variants = [...PARTS, 'portable float best', 'pyramid float best'].map((name) => [name, view(0.2)]);
  const errors = [0.3, 0.5].map((plain) => ({ ...Object.fromEntries(variants), original: view(plain) }));
  const result = { name: 'cloth', kind: 'whole', errors };
  assert.equal(errorOf(result, 'original'), 0.4);
  assert.equal(
    errorOf(result, 'original', 'suns', (i) => i === 1),
    1,
  );
  const rows = tables([result]).split('\n');
  assert.equal(rows[2], '| cloth | 0.400 | 0.200 | 2.00x | 2.00x | 100 % | 0.200 | 2.00x | 2.00x | 100 % |');
});
