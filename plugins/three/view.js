// usage: npm run view -- [<asset.glb>] [<baked.glb>...] [--original <asset.glb>] [--events]
// Serves the page with an asset on this machine until Ctrl-C. Without an asset it bakes and shows a fixture.
// With --events the page reloads when `roughcast watch --json`, on standard input, reports new outputs.
import { readFileSync } from 'node:fs';
import path from 'node:path';
import process from 'node:process';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { refusal } from './page/refusal.js';
import { readDocument, variantOf } from './page/variants.js';
import { show, temporaryFolder } from './show.js';
import { missing, repository, roughcast } from './test/roughcast.js';

const here = path.dirname(fileURLToPath(import.meta.url));

/** Returns which variant a file is. */
function variant(file) {
  const bytes = readFileSync(file);
  const reason = refusal(file, bytes);
  if (reason) throw new Error(`${file}: ${reason}`);
  return variantOf(readDocument(bytes));
}

function fixture() {
  if (missing) throw new Error(missing);
  const [source, folder] = [path.join(repository, 'fixtures/brushed'), temporaryFolder()];
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

try {
  const given = parseArgs({
    allowPositionals: true,
    options: { original: { type: 'string' }, events: { type: 'boolean' } },
  });
  const folders = {
    page: path.join(here, 'page'),
    plugin: path.join(here, 'plugin'),
    three: path.join(here, 'node_modules/three'),
  };
  // The maps of the fixture repeat more often on the sphere of the page, so that bumps are lost at its first distance.
  const subject = given.positionals.length === 0 ? 'sphere' : 'asset';
  const events = given.values.events && process.stdin;
  console.log(await show(variants(given), folders, { subject, events }));
} catch (error) {
  console.error(`view: ${error.message}`);
  process.exit(1);
}
