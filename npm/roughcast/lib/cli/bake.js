// `roughcast bake` on WebAssembly.
import { readFile, realpath, writeFile } from 'node:fs/promises';
import { existsSync } from 'node:fs';
import path from 'node:path';
import { backend } from '#backend';
import { bakeWithSizes } from '../bake.js';
import { stem } from '../names.js';
import { destination } from './destination.js';
import { bufferPaths, findAssets, readIfThere, writeOutput } from './files.js';
import { DOCUMENT, parse } from './options.js';
import { notesToActOn, printable, sum, summary, total } from './summary.js';

const OWN = { ...DOCUMENT, report: { type: 'string' }, 'no-config': { type: 'boolean' } };

const NO_BYTES = { ktx2: 0, fallback: 0, images: 0, geometry: 0, json: 0 };

/** What the report says of an asset that failed. */
const NOTHING = { seconds: 0, inputBytes: 0, bytes: 0, layers: [], textures: [], sizes: NO_BYTES };

/** Bakes inputs one after the other. Returns the exit code. */
export async function bakeCommand(args, stdout, stderr) {
  const started = performance.now();
  const { inputs, settings, values } = parse(args, OWN);
  const { folder, name } = await destination(values.output, inputs, settings);
  const assets = (await Promise.all(inputs.map(findAssets))).flat();
  const { report: run, onAnisotropy } = await (await backend('wasm')).startRun(settings, values.threads);
  const outcomes = [];
  for (const asset of assets) {
    if (!values['no-config']) warnOfConfig(asset.file, stderr);
    const below = path.join(folder, path.dirname(path.relative(asset.folder, asset.file)));
    const outcome = await bakeAsset(asset.file, { folder: below, name }, settings, values.threads);
    outcomes.push(outcome);
    if (outcome.error) stderr.write(`error: ${asset.file}: ${outcome.error}\n`);
    else if (!values.quiet && !values.json) stdout.write(summary(outcome, values.verbose));
  }
  const notes = [...(run.notes ?? [])];
  if (onAnisotropy && outcomes.some(hasAnisotropicLobes)) notes.push(onAnisotropy);
  if (!values.quiet && !values.json) {
    stdout.write(total(outcomes, secondsSince(started)));
    if (!values.verbose) stdout.write(notesToActOn(outcomes));
    for (const note of notes) stdout.write(`note: ${printable(note.text)}\n`);
  }
  const report = `${JSON.stringify({ ...run, assets: outcomes, ...(notes.length > 0 && { notes }) }, null, 2)}\n`;
  if (values.json) stdout.write(report);
  if (values.report) await writeFile(values.report, report);
  return outcomes.some((outcome) => outcome.error) ? 1 : 0;
}

/** Returns whether a layer of an asset was baked to anisotropic lobes. */
const hasAnisotropicLobes = ({ layers }) => layers.some((layer) => layer.model === 'anisotropic');

/** Bakes a file into a folder, to a document called `name` or as the file. Returns what the report says of it. */
async function bakeAsset(file, to, settings, threads) {
  const started = performance.now();
  const outcome = { input: file, status: 'failed', ...NOTHING };
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
    const options = { name: stem(file), files, settings, threads, backend: 'wasm' };
    const baked = await bakeWithSizes(document, options, to.name);
    const output = path.join(to.folder, baked.document.path);
    const copies = await Promise.all(
      baked.copies.map(async (name) => ({ path: name, bytes: await readFile(path.join(folder, name)) })),
    );
    const all = [...copies, ...baked.files, baked.document];
    for (const { path: name, bytes } of all) await writeOutput(path.join(to.folder, name), bytes, sources);
    const { report } = baked;
    const buffers = copies.length > 0 ? bufferPaths(baked.document.bytes) : new Set();
    Object.assign(outcome, {
      output,
      status: report.textures.length > 0 ? 'baked' : 'copied',
      seconds: secondsSince(started),
      inputBytes: read,
      bytes: lengthOf(all),
      ...report,
      // The report counts the document and new files.
      sizes: sum(report.sizes, copiedSizes(copies, buffers)),
    });
  } catch (error) {
    outcome.error = error.message;
  }
  return outcome;
}

/** Returns the sizes of copied files, which are images or `buffers`. */
function copiedSizes(copies, buffers) {
  const [geometry, images] = [true, false].map((wanted) =>
    lengthOf(copies.filter((copy) => buffers.has(path.posix.normalize(copy.path)) === wanted)),
  );
  return { ...NO_BYTES, images, geometry };
}

/** Returns the bytes of files together. */
const lengthOf = (files) => files.reduce((length, { bytes }) => length + bytes.byteLength, 0);

/** Returns the seconds since `start`, a time of `performance.now()`. */
const secondsSince = (start) => (performance.now() - start) / 1e3;

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
