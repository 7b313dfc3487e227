// `roughcast bake` on WebAssembly.
import { readFile, realpath, writeFile } from 'node:fs/promises';
import { existsSync } from 'node:fs';
import path from 'node:path';
import { bake } from '../bake.js';
import { stem } from '../names.js';
import { count, findAssets, readIfThere, size, writeOutput } from './files.js';
import { DOCUMENT, UsageError, parse } from './options.js';

const OWN = { ...DOCUMENT, report: { type: 'string' }, 'no-config': { type: 'boolean' } };

/** Bakes inputs one after the other. Returns the exit code. */
export async function bakeCommand(args, stdout, stderr) {
  const { inputs, settings, values } = parse(args, OWN);
  const assets = (await Promise.all(inputs.map(findAssets))).flat();
  const place = placeOf(values.output, assets, settings);
  const outcomes = [];
  for (const asset of assets) {
    if (!values['no-config']) warnOfConfig(asset.file, stderr);
    const outcome = await bakeAsset(asset, place(asset), settings, values.threads);
    outcomes.push(outcome);
    if (outcome.error) stderr.write(`error: ${asset.file}: ${outcome.error}\n`);
    else if (!values.quiet && !values.json) stdout.write(summary(outcome, values.verbose));
  }
  const report = `${JSON.stringify({ formatVersion: 1, assets: outcomes }, null, 2)}\n`;
  if (values.json) stdout.write(report);
  if (values.report) await writeFile(values.report, report);
  return outcomes.some((outcome) => outcome.error) ? 1 : 0;
}

/** Returns a function from an asset to the path of its output document. */
function placeOf(output, assets, settings) {
  const named = /\.(glb|gltf)$/i.exec(output)?.[1].toLowerCase();
  if (!named) return ({ file, folder }) => path.join(output, path.relative(folder, file));
  if (assets.length > 1)
    throw new UsageError(`-o ${output}: expected one asset, found ${assets.length}; name a folder`);
  if (named === 'gltf' && settings.glb) throw new UsageError(`-o ${output}: expected a .glb with --glb; name one`);
  settings.glb = named === 'glb';
  return () => output;
}

async function bakeAsset({ file }, place, settings, threads) {
  const started = performance.now();
  const outcome = { input: file, status: 'failed' };
  try {
    const [document, folder] = [await readFile(file), path.dirname(file)];
    const sources = new Set([await realpath(file)]);
    let read = document.byteLength;
    const files = async (name) => {
      const bytes = await readIfThere(path.join(folder, name));
      if (bytes) sources.add(await realpath(path.join(folder, name)));
      read += bytes?.byteLength ?? 0;
      return bytes;
    };
    const baked = await bake(document, { name: stem(place), files, settings, threads, backend: 'wasm' });
    const output = path.join(path.dirname(place), baked.document.path);
    const copies = await Promise.all(
      baked.copies.map(async (name) => ({ path: name, bytes: await readFile(path.join(folder, name)) })),
    );
    const all = [...copies, ...baked.files, baked.document];
    for (const { path: name, bytes } of all) await writeOutput(path.join(path.dirname(place), name), bytes, sources);
    Object.assign(outcome, { output, status: baked.report.textures.length > 0 ? 'baked' : 'copied' });
    outcome.bytes = all.reduce((sum, { bytes }) => sum + bytes.byteLength, 0);
    Object.assign(outcome, { bytesRead: read, seconds: (performance.now() - started) / 1e3, ...baked.report });
  } catch (error) {
    outcome.error = error.message;
  }
  return outcome;
}

/** Returns a line about an asset, and its notes. Without `verbose`, notes that ask for nothing are left out. */
function summary({ output, layers, textures, bytesRead, bytes, seconds }, verbose) {
  const materials = new Set(layers.filter((layer) => layer.model).map((layer) => layer.index)).size;
  const counts = [count(materials, 'material'), count(textures.length, 'texture')].join(', ');
  const what = `${counts}, ${size(bytesRead)} -> ${size(bytes)}`;
  const lines = [`${output}: ${what}, ${seconds.toFixed(1)} s (WebAssembly)`];
  for (const { material, notes } of layers) {
    const shown = notes.filter((note) => verbose || note.asksForAction);
    lines.push(...shown.map((note) => `  ${material}: ${note.text}`));
  }
  return `${lines.join('\n')}\n`;
}

/** Warns that the settings of a roughcast.toml are not used. */
function warnOfConfig(file, stderr) {
  for (let folder = path.resolve(path.dirname(file)); ; folder = path.dirname(folder)) {
    const config = path.join(folder, 'roughcast.toml');
    if (existsSync(config)) {
      stderr.write(`warning: ${config} is not read by WebAssembly; install the native tool, or pass --no-config\n`);
      return;
    }
    if (folder === path.dirname(folder)) return;
  }
}
