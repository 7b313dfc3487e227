// Prints the table of docs/sizes.md: bytes of textures, seconds of CPU time, and the quality of base colours. Needs
// Linux, whose /proc counts the time of finished child processes.
// usage: node run.mjs [--tool ROUGHCAST] [--only TEXT] ASSET...
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { basename, join } from 'node:path';
import { tmpdir } from 'node:os';
import { parseArgs } from 'node:util';

import { decode, io, RECIPES } from './recipes.mjs';

const { values, positionals } = parseArgs({
  options: { tool: { type: 'string', default: 'roughcast' }, only: { type: 'string', default: '' } },
  allowPositionals: true,
});
if (positionals.length === 0) {
  console.error('usage: node run.mjs [--tool ROUGHCAST] [--only TEXT] ASSET...');
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
  const folder = mkdtempSync(join(tmpdir(), 'sizes-'));
  try {
    const file = join(folder, 'texture.ktx2');
    writeFileSync(file, texture.getImage());
    execFileSync(values.tool, ['inspect', file, '--extract', join(folder, 'levels')]);
    const [first] = readdirSync(join(folder, 'levels')).sort();
    return await decode(readFileSync(join(folder, 'levels', first)));
  } finally {
    rmSync(folder, { recursive: true });
  }
}

/** Returns the squared errors of the base colours of all materials, summed over RGB, and the number of samples. */
async function colourError(document, source) {
  const of = (root) => root.getRoot().listMaterials().map((material) => material.getBaseColorTexture());
  const sources = of(source);
  let [sum, count] = [0, 0];
  for (const [index, texture] of of(document).entries()) {
    if (!texture || sources[index].getMimeType() === 'image/ktx2') continue;
    const [found, wanted] = [await level0(texture), await level0(sources[index])];
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

const megabytes = (bytes) => (bytes / 1e6).toFixed(2);
const names = positionals.map((path) => basename(path).replace(/\.(gltf|glb)$/, ''));
const sources = await Promise.all(positionals.map((path) => io.read(path)));
console.log(`| textures by | ${names.join(' | ')} | all, MB | CPU seconds | base colour, dB |`);
console.log(`|---|${'---|'.repeat(names.length + 3)}`);
for (const [name, make] of RECIPES.filter(([name]) => name.includes(values.only))) {
  const cells = [];
  let [total, seconds, error] = [0, 0, { sum: 0, count: 0 }];
  for (const [index, input] of positionals.entries()) {
    const start = cpuSeconds();
    const document = await make(input, values.tool);
    seconds += cpuSeconds() - start;
    const bytes = textureBytes(document);
    total += bytes;
    cells.push(megabytes(bytes));
    const own = error && (await colourError(document, sources[index]));
    error = own && { sum: error.sum + own.sum, count: error.count + own.count };
  }
  const psnr = error && error.sum > 0 ? (10 * Math.log10((65025 * error.count) / error.sum)).toFixed(1) : '';
  console.log(`| ${name} | ${cells.join(' | ')} | ${megabytes(total)} | ${seconds.toFixed(1)} | ${psnr} |`);
}
