// Loads a baked asset of each profile and form in each engine, and reads every level of every texture back.
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { launch } from '../browser.js';
import { serve } from '../server.js';
import { match } from '../test/levels.js';
import { example, levels, repository, roughcast } from '../test/roughcast.js';

const ENGINES = {
  'three.js': { page: 'three', npm: 'three', hasPlugin: true },
  'Babylon.js': { page: 'babylon', npm: '@babylonjs/core' },
  PlayCanvas: { page: 'playcanvas', npm: 'playcanvas' },
  Filament: { page: 'filament', npm: 'filament' },
};
const PROFILES = ['portable', 'pyramid'];
const FORMS = ['fallback', 'strict', 'dual'];

/**
 * Mean difference in bytes that a level may have: BC7 and ASTC keep UASTC to 1, and BC3 (Filament) has 5 and 6 bits.
 */
const TOLERANCE = 8;

/**
 * Runs all engines on bakes in `folder`.
 *
 * @returns {Promise<{engine: string, profile: string, form: string, outcome: string}[]>}
 */
export async function run(folder) {
  const assets = PROFILES.flatMap((profile) => FORMS.map((form) => bake(folder, profile, form)));
  const modules = ['three', '@babylonjs', 'playcanvas', 'filament'].map((name) => [
    name,
    path.join(example, 'node_modules', name),
  ]);
  const server = await serve({
    ...Object.fromEntries(modules),
    engines: path.join(example, 'engines'),
    plugin: path.join(example, 'plugin'),
    assets: folder,
  });
  const browser = await launch();
  try {
    const cells = Object.keys(ENGINES).flatMap((engine) => assets.map((asset) => ({ engine, ...asset })));
    // Two pages at a time, since most of a load is waiting.
    const [outcomes, queue] = [[], cells.entries()];
    const work = async () => {
      for (const [index, { engine, profile, form, files }] of queue) {
        const found = await outcome(browser, server.url, engine, profile, form, files);
        outcomes[index] = { engine, profile, form, outcome: found };
      }
    };
    await Promise.all([work(), work()]);
    return outcomes;
  } finally {
    await browser.close();
    await server.close();
  }
}

function bake(folder, profile, form) {
  const name = `${profile}-${form}`;
  const output = path.join(folder, name);
  roughcast(
    'bake',
    path.join(repository, 'fixtures/brushed'),
    '-o',
    output,
    '--profile',
    profile,
    '--gltf',
    form,
    '--quiet',
  );
  return { profile, form, files: levels(path.join(output, 'brushed.gltf'), path.join(folder, `${name}-levels`)) };
}

async function outcome(browser, url, engine, profile, form, files) {
  const context = await browser.newContext();
  await context.addInitScript({ path: path.join(example, 'engines/probe.js') });
  const page = await context.newPage();
  page.setDefaultTimeout(60_000);
  try {
    await page.goto(`${url}/engines/${ENGINES[engine].page}.html`);
    await page.waitForFunction('window.ready');
    const [first] = files.values();
    const found = await page.evaluate(
      async ([gltf, size]) => {
        const late = new Promise((_, reject) => setTimeout(() => reject(new Error('not loaded after 60 s')), 60_000));
        await Promise.race([window.load(gltf), late]);
        return window.probe(size);
      },
      [`${url}/assets/${profile}-${form}/brushed.gltf`, [first[0].width, first[0].height]],
    );
    // Some engines load all textures of a document, even those that they do not shade with.
    return profile === 'portable' || ENGINES[engine].hasPlugin ? verdict(found, files) : 'as it was';
  } catch (error) {
    return `fails: ${error.message.split('\n')[0]}`;
  } finally {
    await context.close();
  }
}

/** Returns `baked` where every file is found with all its levels. */
function verdict(found, files) {
  const own = found.filter((texture) => !texture.generated && texture.uploaded === texture.levels.length);
  const present = [...files.values()].map((file) => {
    const best = match(own, file);
    return best !== null && best.ours < TOLERANCE && best.ours < best.theirs;
  });
  return present.every(Boolean) ? 'baked' : `${present.filter(Boolean).length} of ${present.length} textures`;
}

/** Returns the outcomes as a Markdown table. */
export function table(outcomes) {
  const columns = PROFILES.flatMap((profile) => FORMS.map((form) => [profile, form]));
  const version = (npm) =>
    JSON.parse(readFileSync(path.join(example, 'node_modules', npm, 'package.json'), 'utf8')).version;
  const cell = (engine, [profile, form]) =>
    outcomes.find((o) => o.engine === engine && o.profile === profile && o.form === form).outcome;
  const row = (cells) => `| ${cells.join(' | ')} |`;
  return [
    row(['', ...columns.map(([profile, form]) => `${profile}, ${form}`)]),
    row(['', ...columns].map(() => '---')),
    ...Object.entries(ENGINES).map(([engine, { npm }]) =>
      row([`${engine} ${version(npm)}`, ...columns.map((c) => cell(engine, c))]),
    ),
  ].join('\n');
}
