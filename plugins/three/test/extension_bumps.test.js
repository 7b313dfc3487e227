// The light of one bump in docs/extension/README.md, against the mean over many bumps that do not hide each other.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { masking } from './extension_reader.js';
import { repository } from './roughcast.js';
import { dot, normalised, sum } from './vectors.js';

const FLAT = {
  normal: [0, 0, 1],
  axes: [
    [1, 0, 0],
    [0, 1, 0],
  ],
};
const BUMPS = 1000;
const DIRECTIONS = 500;
/** Slopes of a quantile in (0, 1), for bumps that are the share of a lobe with this squared alpha. */
const SLOPES = {
  normal: (quantile, squared) => Math.sqrt(-1.64 * squared * Math.log(1 - quantile)),
  ggx: (quantile, squared) => Math.sqrt((squared * quantile) / (1 - quantile)),
  disc: (quantile, squared) => 1.2 * Math.sqrt(squared * quantile),
};

/** Returns the isotropic lobe of an alpha about z, of which bumps are a share. */
function lobe(alpha, share) {
  const base = alpha * Math.sqrt(1 - share);
  return { ...FLAT, alphas: [alpha, alpha], baseAlphas: [base, base], shares: [share, share] };
}

/** Returns evenly spread unit vectors that are at least 0.2 above the plane z = 0. */
function directions(count, seed) {
  return Array.from({ length: count }, (_, i) => {
    const [u, v] = [0.7548776662466927, 0.5698402909980532].map((step, axis) => (seed[axis] + i * step) % 1);
    const z = 0.2 + 0.8 * u;
    const radius = Math.sqrt(1 - z * z);
    return [radius * Math.cos(2 * Math.PI * v), radius * Math.sin(2 * Math.PI * v), z];
  });
}

/** Returns GGX's density of half-vectors over the cosine, for an isotropic lobe. */
const distribution = (alpha, cosine) => alpha ** 2 / (Math.PI * (cosine ** 2 * (alpha ** 2 - 1) + 1) ** 2);

/** Returns the light of each bump, and its density of half-vectors, in the mean over all. */
function mean(normals, alpha, eye, light) {
  const h = normalised(sum([eye, 1], [light, 1]));
  let [radiance, density] = [0, 0];
  for (const normal of normals) {
    const cosine = Math.max(dot(normal, h), 0);
    const there = distribution(alpha, cosine);
    const [nv, nl] = [eye, light].map((direction) => Math.max(dot(normal, direction), 0));
    // The term of the base lobe. Where a bump faces away from the light, there is none.
    const length = (c) => Math.sqrt(alpha ** 2 + (1 - alpha ** 2) * c * c);
    radiance += nl > 0 ? (there * nl) / (2 * (nl * length(nv) + nv * length(nl))) : 0;
    density += there * cosine;
  }
  return { radiance: radiance / normals.length, distribution: density / normals.length / h[2] };
}

/** Returns the errors of a lobe for each share of bumps, over the light of bumps with this squared alpha. */
function errorsOf(shares, base, squared, slope) {
  const normals = Array.from({ length: BUMPS }, (_, i) => {
    const [size, angle] = [slope((i + 0.5) / BUMPS, squared), i * Math.PI * (3 - Math.sqrt(5))];
    return normalised([size * Math.cos(angle), size * Math.sin(angle), 1]);
  });
  const whole = Math.sqrt(base ** 2 + squared);
  const lights = directions(DIRECTIONS, [0.1, 0.8]);
  const off = shares.map(() => 0);
  let total = 0;
  for (const [i, eye] of directions(DIRECTIONS, [0.5, 0.5]).entries()) {
    // Lights have another order than eyes, so that all pairs of elevations occur.
    const light = lights[(i * 211) % DIRECTIONS];
    const truth = mean(normals, base, eye, light);
    total += truth.radiance;
    shares.forEach((of, n) => {
      const share = of(squared / whole ** 2);
      off[n] += Math.abs(truth.distribution * masking(lobe(whole, share), eye, light) - truth.radiance);
    });
  }
  return off.map((sum) => sum / total);
}

test('the light of one bump stands for the mean over many', () => {
  const errors = { bumps: [], smith: [] };
  for (const base of [0.05, 0.2, 0.5]) {
    for (const squared of [0.02, 0.144, 0.4]) {
      for (const slope of Object.values(SLOPES)) {
        // Without a share of bumps, the term is that of KHR_materials_anisotropy.
        const [bumps, smith] = errorsOf([(share) => share, () => 0], base, squared, slope);
        errors.bumps.push(bumps);
        errors.smith.push(smith);
      }
    }
  }
  errors.bumps.forEach((error, i) => assert.ok(error < errors.smith[i] + 0.005, `${error} ${errors.smith[i]}`));
  const average = (values) => values.reduce((total, value) => total + value, 0) / values.length;
  const figures = (values) => `${average(values).toFixed(2)} in the mean and ${Math.max(...values).toFixed(2)} at most`;
  const page = readFileSync(path.join(repository, 'docs/extension/README.md'), 'utf8').replace(/\s+/g, ' ');
  for (const values of Object.values(errors)) assert.ok(page.includes(figures(values)), figures(values));
});
