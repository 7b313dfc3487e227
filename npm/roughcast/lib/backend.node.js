// The backends of Node: the native tool if its package is installed, else WebAssembly.
import { readFile } from 'node:fs/promises';
import os from 'node:os';
import process from 'node:process';
import { wasmBackend } from './backend.wasm.js';
import { findBinary } from './binary.js';
import { nativeBackend } from './native.js';

const wasm = wasmBackend({
  load: async (file) => WebAssembly.compile(await readFile(new URL(`../${file}`, import.meta.url))),
  canShare: true,
  processors: os.availableParallelism(),
});

/**
 * Returns a backend.
 *
 * @param {'native' | 'wasm'} [kind] default: $ROUGHCAST_BACKEND, else the native tool if there is one
 */
export async function backend(kind = process.env.ROUGHCAST_BACKEND) {
  if (kind === 'wasm') return wasm;
  if (kind && kind !== 'native') throw new Error(`expected the backend native or wasm, found ${kind}`);
  const { path, why } = findBinary();
  if (path) return nativeBackend(path);
  if (kind === 'native') throw new Error(`expected the native tool, found none: ${why}`);
  return wasm;
}

/** Returns the names of the files that a document refers to. */
export async function listFiles(document, threads) {
  return wasm.listFiles(document, threads);
}
