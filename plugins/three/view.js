// usage: npm run view -- [<asset.glb>] [<baked.glb>...] [--original <asset.glb>] [--events]
// Serves the page with an asset on this machine until Ctrl-C. Without an asset it bakes and shows a fixture.
// With --events the page reloads when `roughcast watch --json`, on standard input, reports new outputs.
import { mkdirSync, mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import process from 'node:process';
import { createInterface } from 'node:readline';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { serve } from './server.js';
import { readDocument, variantOf } from './page/variants.js';
import { missing, repository, roughcast } from './test/roughcast.js';

const here = path.dirname(fileURLToPath(import.meta.url));
const folder = mkdtempSync(path.join(os.tmpdir(), 'roughcast-view-'));
process.on('exit', () => rmSync(folder, { recursive: true, force: true }));
for (const signal of ['SIGINT', 'SIGTERM']) process.on(signal, () => process.exit(0));

/** Returns which variant a file is. */
const variant = (file) => variantOf(readDocument(readFileSync(file)));

function fixture() {
  if (missing) throw new Error(missing);
  const source = path.join(repository, 'fixtures/brushed');
  for (const name of ['portable', 'pyramid'])
    roughcast('bake', source, '-o', path.join(folder, name), '--profile', name, '--engine', 'three', '--quiet');
  const baked = (name) => path.join(folder, name, 'brushed.gltf');
  return { original: path.join(source, 'brushed.gltf'), portable: baked('portable'), pyramid: baked('pyramid') };
}

/** Resolves a path against the folder of the caller: npm runs scripts in the folder of package.json. */
const resolve = (file) => path.resolve(process.env.INIT_CWD ?? '.', file);

/** Returns the files of the variants that were named. */
function variants({ positionals, values }) {
  if (positionals.length === 0) return fixture();
  const all = Object.fromEntries(positionals.map((file) => [variant(resolve(file)), resolve(file)]));
  return values.original ? { original: resolve(values.original), ...all } : all;
}

/** Returns whether a line of `roughcast watch --json` reports new outputs. */
function reportsOutputs(line) {
  try {
    return ['baked', 'removed'].includes(JSON.parse(line).event);
  } catch {
    return false;
  }
}

try {
  const given = parseArgs({
    allowPositionals: true,
    options: { original: { type: 'string' }, events: { type: 'boolean' } },
  });
  const files = variants(given);
  // The maps of the fixture repeat more often on the sphere of the page, so that bumps are lost at its first distance.
  const subject = given.positionals.length === 0 ? 'sphere' : 'asset';
  // Each asset has a folder of its own, since two assets may have files of one name.
  const folders = Object.fromEntries(
    Object.entries(files).map(([name, file]) => [`asset-${name}`, path.dirname(file)]),
  );
  const urls = Object.entries(files).map(([name, file]) => [
    name,
    `/asset-${name}/${encodeURIComponent(path.basename(file))}`,
  ]);
  for (const file of Object.values(files)) statSync(file);
  mkdirSync(path.join(folder, 'view'));
  const shown = JSON.stringify({ variants: Object.fromEntries(urls), subject });
  writeFileSync(path.join(folder, 'view', 'variants.json'), shown);
  const server = await serve({
    ...folders,
    view: path.join(folder, 'view'),
    page: path.join(here, 'page'),
    plugin: path.join(here, 'plugin'),
    three: path.join(here, 'node_modules/three'),
  });
  console.log(`${server.url}/page/index.html`);
  if (given.values.events)
    createInterface({ input: process.stdin }).on('line', (line) => reportsOutputs(line) && server.reportBake());
} catch (error) {
  console.error(`view: ${error.message}`);
  process.exit(1);
}
