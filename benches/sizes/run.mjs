// Prints the table of docs/sizes.md: bytes of textures, CPU seconds, and the quality of base colours.
// Needs Linux, whose /proc counts the CPU time of finished child processes.
// Each --only measures the rows whose names have its text. Slow rows are measured only if an --only chooses them.
// usage: node run.mjs [--tool ROUGHCAST] [--only TEXT]... ASSET...
import { readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { basename, join } from 'node:path';
import process from 'node:process';
import { parseArgs } from 'node:util';

import { inFolder, missingPrograms, run } from './programs.mjs';
import { decode, io, RECIPES } from './recipes.mjs';

const { values, positionals } = parseArgs({
  options: { tool: { type: 'string', default: 'roughcast' }, only: { type: 'string', multiple: true } },
  allowPositionals: true,
});
if (positionals.length === 0) {
  console.error('usage: node run.mjs [--tool ROUGHCAST] [--only TEXT]... ASSET...');
  process.exit(2);
}

/** Returns the bytes of all images of a document. */
function textureBytes(document) {
  const textures = document.getRoot().listTextures();
  return textures.reduce((sum, texture) => sum + (texture.getImage()?.byteLength ?? 0), 0);
}

/** Returns the RGBA8 texels of level 0 of an image: KTX2 by the tool's decoder, others by sharp. */
async function level0(texture) {
  if (texture.getMimeType() !== 'image/ktx2') return decode(texture.getImage());
  return inFolder((folder) => {
    const file = join(folder, 'texture.ktx2');
    writeFileSync(file, texture.getImage());
    run(values.tool, 'inspect', file, '--extract', join(folder, 'levels'));
    const [first] = readdirSync(join(folder, 'levels')).sort();
    return decode(readFileSync(join(folder, 'levels', first)));
  });
}

/** Returns the squared errors of the base colours of all materials, summed over RGB, and the number of samples. */
async function colourError(document, source) {
  const byName = new Map(source.getRoot().listMaterials().map((material) => [material.getName(), material]));
  let [sum, count] = [0, 0];
  for (const material of document.getRoot().listMaterials()) {
    const texture = material.getBaseColorTexture();
    const original = byName.get(material.getName()).getBaseColorTexture();
    if (!texture || original.getMimeType() === 'image/ktx2') continue;
    const [found, wanted] = [await level0(texture), await level0(original)];
    if (found.width !== wanted.width || found.height !== wanted.height) return null;
    for (let i = 0; i < wanted.data.length; i += 1) {
      if (i % 4 === 3) continue;
      sum += (found.data[i] - wanted.data[i]) ** 2;
      count += 1;
    }
  }
  return { sum, count };
}

/** Returns the seconds of CPU time of this process and of its finished children. */
function cpuSeconds() {
  const fields = readFileSync('/proc/self/stat', 'utf8').split(') ')[1].split(' ');
  // User and system time of the process and of its children, in hundredths of a second.
  return fields.slice(11, 15).reduce((sum, ticks) => sum + Number(ticks), 0) / 100;
}

/** Runs a recipe on an asset; returns the document with the seconds of CPU time. */
async function timed(make, input) {
  const cpu = cpuSeconds();
  const document = await make(input, values.tool);
  return { document, cpu: cpuSeconds() - cpu };
}

/** Returns the peak signal-to-noise ratio in dB, or nothing where images have another size or no error. */
const decibels = (error) =>
  error && error.sum > 0 ? (10 * Math.log10((65025 * error.count) / error.sum)).toFixed(1) : '';

const megabytes = (bytes) => (bytes / 1e6).toFixed(2);

/** Measures a recipe on all assets and returns the cells of its row. */
async function measure(make) {
  const bytes = [];
  let [cpu, error] = [0, { sum: 0, count: 0 }];
  for (const [index, input] of positionals.entries()) {
    const result = await timed(make, input);
    cpu += result.cpu;
    bytes.push(textureBytes(result.document));
    const own = error && (await colourError(result.document, sources[index]));
    error = own && { sum: error.sum + own.sum, count: error.count + own.count };
  }
  const total = bytes.reduce((sum, own) => sum + own, 0);
  return [...[...bytes, total].map(megabytes), cpu.toFixed(1), decibels(error)];
}

const isChosen = ({ name, isSlow }) => (values.only ? values.only.some((text) => name.includes(text)) : !isSlow);

const printRow = (cells) => console.log(`| ${cells.join(' | ')} |`);

const names = positionals.map((path) => basename(path).replace(/\.(gltf|glb)$/, ''));
const sources = await Promise.all(positionals.map((path) => io.read(path)));
const missing = await missingPrograms();
for (const program of missing) {
  console.error(`${program} is missing or has no Basis: its rows are left out. \`benches/sizes/install\` builds it.`);
}
printRow(['textures by', ...names, 'all, MB', 'CPU seconds', 'base colour, dB']);
console.log(`|${'---|'.repeat(names.length + 4)}`);
for (const { name, make, program } of RECIPES.filter(isChosen)) {
  if (!missing.includes(program)) printRow([name, ...(await measure(make))]);
}
