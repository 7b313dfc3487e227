// The plugin against three.js' own materials: surfaces of one slope and one K have an exact counterpart there.
import assert from 'node:assert/strict';
import test, { after, before } from 'node:test';
import path from 'node:path';
import { launch, missing, open } from '../browser.js';
import { serve } from '../server.js';
import { example } from './roughcast.js';

let server, browser, page;
before(async () => {
  if (missing) return;
  server = await serve({
    engines: path.join(example, 'engines'),
    plugin: path.join(example, 'plugin'),
    three: path.join(example, 'node_modules/three'),
  });
  browser = await launch();
  page = await open(browser, `${server.url}/engines/shading.html`);
  await page.waitForFunction('window.ready');
});
after(async () => {
  await browser?.close();
  await server?.close();
});

/**
 * A metal so dark that light between facets is negligible. Pyramids differ in that light, which has a test of its own.
 */
const DARK = { metalness: 1, color: 0x272727 };
const PLANE = { width: 1, height: 1, tangents: true, mirrored: false, behind: false };

/** Returns the parameters of KHR_materials_anisotropy for A = [uu, uv, vv]. */
function lobe([uu, uv, vv]) {
  const radius = Math.hypot((uu - vv) / 2, uv);
  const [along, across] = [(uu + vv) / 2 + radius, (uu + vv) / 2 - radius].map(Math.sqrt);
  const anisotropy = Math.sqrt((along - across) / (1 - across));
  return { ...DARK, roughness: Math.sqrt(across), anisotropy, anisotropyRotation: 0.5 * Math.atan2(2 * uv, uu - vv) };
}

/** Returns the alphas of the base lobe and the shares of bumps, from squared alphas along two axes. */
const partsOf = (wholes, bumps) => ({
  alphas: wholes.map((whole, i) => Math.sqrt(whole - bumps[i])),
  shares: wholes.map((whole, i) => bumps[i] / whole),
});

/** Returns a material with the lobe A = [uu, uv, vv], of which `bumps` = [uu, uv, vv] are bumps, and both parts. */
function bumpy(sum, bumps) {
  const own = lobe(sum);
  const [c, s] = [Math.cos(own.anisotropyRotation), Math.sin(own.anisotropyRotation)];
  const along = ([uu, uv, vv]) => [uu * c * c + 2 * uv * c * s + vv * s * s, uu * s * s - 2 * uv * c * s + vv * c * c];
  return { own, parts: partsOf(along(sum), along(bumps)) };
}

const normal = ([u, v]) => [-u, -v, 1].map((c) => c / Math.hypot(u, v, 1));

async function assertAlike(pyramid, plain) {
  const found = await page.evaluate((o) => window.pyramid(o), { plane: PLANE, ...pyramid });
  const expected = await page.evaluate((o) => window.plain(o), { plane: PLANE, ...plain });
  const brightest = Math.max(...expected.filter((_, i) => i % 4 < 3));
  assert.ok(brightest > 0.01, `the light is seen: ${brightest}`);
  const worst = Math.max(...found.map((value, i) => Math.abs(value - expected[i])));
  assert.ok(worst < 0.01 * brightest, `off by ${worst} of ${brightest}`);
  assert.deepEqual(page.problems, []);
}

const options = { skip: missing };
const ALPHA = 0.2;
const OWN = { ...DARK, roughness: Math.sqrt(ALPHA) };
// D = [[d1, d2], [0, d3]] and K = D D^T.
const [D, K] = [
  [0.2, 0.1, 0.1],
  [0.05, 0.01, 0.01],
];
const C = 0.8;
const bumps = (k) => k.map((value) => 2 * C * value);
const roughened = ([uu, uv, vv]) => [ALPHA ** 2 + 2 * C * uu, 2 * C * uv, ALPHA ** 2 + 2 * C * vv];
const rough = (k) => bumpy(roughened(k), bumps(k));
/** Returns the base lobe with bumps of this standard deviation. */
function isotropic(lambda1) {
  const bump = 2 * C * lambda1 ** 2;
  const squared = ALPHA ** 2 + bump;
  return { own: { ...OWN, roughness: squared ** 0.25 }, parts: partsOf([squared, squared], [bump, bump]) };
}
const FLAT = { own: OWN, offset: [0, 0], lost: D, correctionFactor: C, frame: 'unit' };

test('D gives the anisotropic lobe of a physical material', options, async () => {
  for (const type of ['MeshStandardMaterial', 'MeshPhysicalMaterial']) {
    await assertAlike({ ...FLAT, type }, { ...rough(K), normal: [0, 0, 1] });
  }
});

test('K = 0 leaves the base lobe', options, async () => {
  await assertAlike({ ...FLAT, lost: [0, 0, 0] }, { own: OWN, normal: [0, 0, 1] });
  await assertAlike({ ...FLAT, lost: null }, { own: OWN, normal: [0, 0, 1] });
  await assertAlike({ ...FLAT, correctionFactor: 0 }, { own: OWN, normal: [0, 0, 1] });
});

test('adds K to an anisotropic base lobe', options, async () => {
  const own = lobe([0.09, 0.02, 0.04]);
  const sum = [0.09 + 2 * C * K[0], 0.02 + 2 * C * K[1], 0.04 + 2 * C * K[2]];
  await assertAlike({ ...FLAT, own }, { ...bumpy(sum, bumps(K)), normal: [0, 0, 1] });
});

test('lambda_1 roughens isotropic and anisotropic base lobes alike in all directions', options, async () => {
  await assertAlike({ ...FLAT, lost: [0.3] }, { ...isotropic(0.3), normal: [0, 0, 1] });
  const sum = [0.09 + 2 * C * 0.04, 0.02, 0.04 + 2 * C * 0.04];
  const whole = bumpy(sum, bumps([0.04, 0, 0.04]));
  await assertAlike({ ...FLAT, own: lobe([0.09, 0.02, 0.04]), lost: [0.2] }, { ...whole, normal: [0, 0, 1] });
});

test('bumps lose no light to each other', options, async () => {
  const metal = { metalness: 1, color: 0xffffff };
  for (const lost of [D, [0.3]]) {
    const { own: whole, parts } = lost === D ? rough(K) : isotropic(0.3);
    const drawn = await page.evaluate((o) => window.pyramid(o), {
      ...FLAT,
      plane: PLANE,
      lost,
      own: { ...OWN, ...metal },
    });
    const three = await page.evaluate((o) => window.plain(o), {
      own: { ...whole, ...metal },
      parts,
      normal: [0, 0, 1],
      plane: PLANE,
    });
    // three.js gives back the light that a rough metal loses; the pyramid gives back what the smoother base lobe loses.
    const ratio = Math.max(...drawn.filter((_, i) => i % 4 < 3)) / Math.max(...three.filter((_, i) => i % 4 < 3));
    assert.ok(ratio > 0.7 && ratio < 0.99, `${ratio}`);
  }
});

test('diffuse light is the mean over the normals of the bumps', options, async () => {
  const own = { metalness: 0, color: 0xffffff, specularIntensity: 0, roughness: 1 };
  const drawn = async (name, change, environment) => {
    const plane = { ...PLANE, environment };
    return (await page.evaluate(([n, o]) => window[n](o), [name, { own, plane, ...change }])).filter(
      (_, i) => i % 4 < 3,
    );
  };
  const flat = { normal: [0, 0, 1] };
  const length = 1 / Math.sqrt(1 + C * (K[0] + K[2]));
  const isClose = (found, expected) => {
    const brightest = Math.max(...expected);
    assert.ok(brightest > 0.01, `the light is seen: ${brightest}`);
    found.forEach((value, i) => assert.ok(Math.abs(value - expected[i]) < 2e-3 * brightest, `${value} ${expected[i]}`));
  };
  const direct = await drawn('plain', flat);
  isClose(
    await drawn('pyramid', { ...FLAT, own }),
    direct.map((light) => length * light),
  );
  const [above, below] = [await drawn('plain', flat, 'above'), await drawn('plain', flat, 'below')];
  assert.ok(Math.max(...above) > 2 * Math.max(...below), 'the halves differ');
  // Seen from the normal, the half below is the half above as seen from its opposite.
  isClose(
    await drawn('pyramid', { ...FLAT, own }, 'above'),
    above.map((light, i) => 0.5 * (light + below[i] + length * (light - below[i]))),
  );
});

const SLOPE = [0.3, -0.2];
const BUMPY = { ...FLAT, offset: SLOPE, lost: [0.2] };
const ISOTROPIC = { ...isotropic(0.2), normal: normal(SLOPE) };

test('offsets tilt the normal, with and without tangents, from behind and in mirrored nodes', options, async () => {
  for (const change of [
    {},
    { tangents: false },
    { behind: true },
    { mirrored: true },
    { mirrored: true, tangents: false },
  ]) {
    const plane = { ...PLANE, ...change };
    await assertAlike({ ...BUMPY, plane }, { ...ISOTROPIC, plane });
  }
});

test('rebuilds the z of offsets in two channels', options, async () => {
  await assertAlike({ ...BUMPY, channels: 2 }, ISOTROPIC);
});

test('natural offsets are heights per repeat', options, async () => {
  const plane = { ...PLANE, width: 2, height: 4 };
  const offset = [SLOPE[0] * 2, SLOPE[1] * 4];
  for (const tangents of [true, false]) {
    const natural = { ...BUMPY, offset, frame: 'natural', lost: null, plane: { ...plane, tangents } };
    await assertAlike(natural, { own: OWN, normal: normal(SLOPE), plane: { ...plane, tangents } });
    // D also is per repeat: its rows are divided by 2 and 4.
    const anisotropic = { ...FLAT, frame: 'natural', lost: [D[0], D[1], 2 * D[2]], plane: { ...plane, tangents } };
    await assertAlike(anisotropic, {
      ...rough(K.map((k) => k / 4)),
      normal: [0, 0, 1],
      plane: { ...plane, tangents },
    });
  }
});

test('a main direction needs no tangents', options, async () => {
  // On the plane z = 0, m = x has e1 = m x n = -y and e2 = n x e1 = x.
  const main = { ...BUMPY, frame: 'mainDirection', mainDirection: [1, 0, 0], offset: [-SLOPE[1], SLOPE[0]] };
  const rotated = { ...FLAT, frame: 'mainDirection', mainDirection: [1, 0, 0] };
  // With tangents, three.js computes B of a mirrored mesh from the mirrored T and N, which flips the bumps of its own
  // normal maps.
  for (const change of [{}, { tangents: false }, { behind: true }, { mirrored: true, tangents: false }]) {
    const plane = { ...PLANE, ...change };
    await assertAlike({ ...main, plane }, { ...ISOTROPIC, plane });
    await assertAlike({ ...rotated, plane }, { ...rough([K[2], -K[1], K[0]]), normal: [0, 0, 1], plane });
  }
});

test('no light is negative where a bump faces away from the eye', options, async () => {
  const steep = { ...FLAT, own: { ...OWN, roughness: 0.1 }, lost: [0.9], correctionFactor: 1 };
  const lit = [];
  for (let degrees = 0; degrees < 360; degrees += 15) {
    const [u, v] = [Math.cos, Math.sin].map((f) => 12 * f((degrees * Math.PI) / 180));
    const drawn = await page.evaluate((o) => window.pyramid(o), { ...steep, plane: PLANE, offset: [u, v] });
    const light = drawn.filter((_, i) => i % 4 < 3);
    assert.ok(Math.min(...light) >= 0, `${degrees} degrees: ${Math.min(...light)}`);
    lit.push(Math.max(...light));
  }
  assert.ok(Math.max(...lit) > 0.01, 'the light is seen');
});
