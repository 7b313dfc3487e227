// usage: npm run gains -- FOLDER [--only NAME,...] [--output DIR] [--pixels N] [--stock=OPTIONS]
// Prints the tables of docs/engines.md on the reachable gain. FOLDER holds materials as <name>/<name>.gltf, and
// OPTIONS are added to those of the bakes for three.js without the plugin.
import { createHash } from 'node:crypto';
import { existsSync, mkdirSync, readFileSync, readdirSync, statSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { example, repository } from '../test/roughcast.js';
import { KINDS, forEach, found } from './run.js';
import { tables } from './table.js';

/** Levels at the centre of a picture, in between mip levels, and samples per pixel of the truth. */
const LEVELS = [
  [1.5, 144],
  [3.5, 576],
  [5.5, 1152],
];
/** Directions of the lights, one at a time, from all around and from three elevations. */
const LIGHTS = Array.from({ length: 12 }, (_, i) => ({ azimuth: 30 * i, elevation: [25, 40, 60][i % 3] }));

/** Changes of these files make new truths. */
const PROGRAMS = [
  path.join(example, 'looks/lights.js'),
  ...['debug.js', 'direction.js', 'stage.js', 'subject.js', 'supersample.js', 'surroundings.js'].map((name) =>
    path.join(example, 'page', name),
  ),
  path.join(example, 'package-lock.json'),
];

const { values, positionals } = parseArgs({
  allowPositionals: true,
  options: {
    only: { type: 'string' },
    output: { type: 'string', default: path.join(repository, 'target/gains') },
    pixels: { type: 'string', default: '48' },
    stock: { type: 'string', default: '' },
  },
});
if (positionals.length !== 1) {
  console.error('usage: npm run gains -- FOLDER [--only NAME,...] [--output DIR] [--pixels N] [--stock=OPTIONS]');
  process.exit(2);
}
const STOCK = ['--engine', 'three', ...values.stock.split(' ').filter(Boolean)];
const PYRAMID = ['--engine', 'three', '--profile', 'pyramid'];
const BEST = ['--quality', 'best'];
const FLOAT = ['--target', 'float'];
/** Options of each bake. `reflected` draws `anisotropic` with the reflections of the plugin. */
const BAKES = {
  portable: STOCK,
  'portable best': [...STOCK, ...BEST],
  'portable float': [...STOCK, ...FLOAT],
  'portable float best': [...STOCK, ...FLOAT, ...BEST],
  anisotropic: [],
  pyramid: PYRAMID,
  'pyramid best': [...PYRAMID, ...BEST],
  'pyramid float': [...PYRAMID, ...FLOAT],
  'pyramid float best': [...PYRAMID, ...FLOAT, ...BEST],
};
const NAMES = ['original', ...Object.keys(BAKES), 'reflected'].filter((name) => name !== 'anisotropic');

const only = values.only?.split(',');
const chosen = found(positionals[0]).filter(([name]) => !only || only.includes(name));
const views = KINDS.flatMap((kind) =>
  LEVELS.map(([level, samples]) => ({ kind, level, size: Number(values.pixels), samples, lights: LIGHTS })),
);
mkdirSync(path.join(values.output, 'truths'), { recursive: true });

const results = [];
const stored = path.join(values.output, 'results.json');
const measure = async (name, page) => {
  const errors = [];
  for (const view of views) {
    const truth = await truthOf(name, view, page);
    errors.push(await page.evaluate((o) => window.gains(o), { view, names: NAMES, truth }));
  }
  results.push({ name, kind: kindOf(name), errors });
  writeFileSync(stored, JSON.stringify({ views: views.map(({ kind, level }) => ({ kind, level })), results }, null, 1));
  if (page.problems.length) console.error(`${name}: ${page.problems.join('; ')}`);
  console.error(`${name} is measured`);
};
const cached = Object.fromEntries(
  Object.entries(BAKES).map(([name, options]) => [name, [...options, '--cache', path.join(values.output, 'cache')]]),
);
await forEach(values.output, chosen, measure, cached);
console.log(tables(results));

/** Returns the URL of the truth of a view, which is drawn if no earlier run has kept it. */
async function truthOf(name, view, page) {
  const source = chosen.find(([known]) => known === name)[1];
  const hash = createHash('sha256').update(JSON.stringify(view));
  const files = readdirSync(source, { recursive: true })
    .sort()
    .map((file) => path.join(source, file))
    .filter((file) => statSync(file).isFile());
  for (const file of [...files, ...PROGRAMS]) hash.update(readFileSync(file));
  const file = path.join('truths', `${name}-${hash.digest('hex').slice(0, 16)}.bin`);
  if (!existsSync(path.join(values.output, file))) {
    const pixels = await page.evaluate((v) => window.truths(v), view);
    writeFileSync(path.join(values.output, file), Buffer.from(pixels, 'base64'));
  }
  return `/baked/${file}`;
}

/** Returns `whole` for a material with a map of its base colour, and `metal` or `dielectric` for one with a colour. */
function kindOf(name) {
  const file = path.join(chosen.find(([known]) => known === name)[1], `${name}.gltf`);
  const { materials } = JSON.parse(readFileSync(file, 'utf8'));
  if (materials.some((m) => m.pbrMetallicRoughness?.baseColorTexture)) return 'whole';
  return materials.some((m) => m.pbrMetallicRoughness?.metallicFactor === 0) ? 'dielectric' : 'metal';
}
