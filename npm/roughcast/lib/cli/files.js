// Files of the command line: inputs, and outputs that are never half-written.
import { mkdir, readFile, readdir, realpath, rename, rm, stat, writeFile } from 'node:fs/promises';
import path from 'node:path';
import process from 'node:process';
import { isGlb } from '../names.js';

/**
 * Finds the assets that an input names.
 *
 * @returns {Promise<{file: string, folder: string}[]>} each with the folder that its output path is relative to
 */
export async function findAssets(input) {
  const facts = await stat(input).catch(() => undefined);
  if (!facts) throw new Error(`${input}: expected a .gltf or .glb file or a folder, found nothing; check the path`);
  if (!facts.isDirectory()) return [{ file: input, folder: path.dirname(input) }];
  const entries = await readdir(input, { recursive: true, withFileTypes: true });
  const files = entries
    .filter((entry) => entry.isFile() && /\.(gltf|glb)$/i.test(entry.name))
    .map((entry) => path.join(entry.parentPath, entry.name));
  if (files.length === 0) throw new Error(`${input}: expected .gltf or .glb files below this folder, found none`);
  return files.sort().map((file) => ({ file, folder: input }));
}

/** Reads a file; `null` if there is none. */
export async function readIfThere(file) {
  return readFile(file).catch((error) => {
    if (error.code === 'ENOENT') return null;
    throw error;
  });
}

/** Writes a file beside its place and then moves it there. Sources, whose real paths are given, are never written. */
export async function writeOutput(file, bytes, sources) {
  const folder = path.dirname(file);
  await mkdir(folder, { recursive: true });
  const real = path.join(await realpath(folder), path.basename(file));
  if (sources.has(real)) throw new Error(`${file}: expected an output that is no source; choose another -o`);
  const beside = path.join(folder, `.${path.basename(file)}.${process.pid}.tmp`);
  try {
    await writeFile(beside, bytes, { flush: true });
    await rename(beside, file);
  } catch (error) {
    await rm(beside, { force: true });
    throw error;
  }
}

/** Returns the paths of the buffers that a .gltf or .glb file names, relative to it. */
export function bufferPaths(document) {
  const view = new DataView(document.buffer, document.byteOffset, document.byteLength);
  const json = isGlb(document) ? document.subarray(20, 20 + view.getUint32(12, true)) : document;
  const { buffers = [] } = JSON.parse(new TextDecoder().decode(json));
  const uris = buffers.map(({ uri }) => uri).filter((uri) => uri && !uri.startsWith('data:'));
  return new Set(uris.map((uri) => path.posix.normalize(decoded(uri))));
}

/** Returns a URI without its percent-encoding. */
function decoded(uri) {
  try {
    return decodeURIComponent(uri);
  } catch {
    return uri;
  }
}

/** Returns a size for a person. */
export function size(bytes) {
  if (bytes < 1e6) return `${(bytes / 1e3).toFixed(1)} kB`;
  return `${(bytes / 1e6).toFixed(1)} MB`;
}

/** Returns a number with its noun. */
export function count(number, noun) {
  return `${number} ${noun}${number === 1 ? '' : 's'}`;
}
