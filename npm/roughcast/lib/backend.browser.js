// The backend of browsers: WebAssembly, fetched once from beside this folder.
import { wasmBackend } from './backend.wasm.js';
import { sharedMemory } from './threads.js';

/** Where the modules are. Bundlers find the files by these expressions. */
const MODULES = {
  'roughcast.wasm': () => new URL('../roughcast.wasm', import.meta.url),
  'roughcast.threads.wasm': () => new URL('../roughcast.threads.wasm', import.meta.url),
};

let wasm;

/** Returns the backend. */
export async function backend(kind = 'wasm') {
  if (kind !== 'wasm') throw new Error(`expected the backend wasm, found ${kind}; browsers have no other`);
  wasm ??= wasmBackend({ load, canShare: canShare(), processors: navigator.hardwareConcurrency });
  return wasm;
}

/** Returns the names of the files that a document refers to. */
export async function listFiles(document, threads) {
  return (await backend()).listFiles(document, threads);
}

/** Returns whether workers can share memory: on pages that are cross-origin isolated, where the memory is granted. */
function canShare() {
  try {
    return globalThis.crossOriginIsolated && typeof Worker === 'function' && Boolean(sharedMemory());
  } catch {
    return false;
  }
}

async function load(file) {
  const url = MODULES[file]();
  const response = await fetch(url);
  if (!response.ok)
    throw new Error(`expected the WebAssembly module at ${url}, found ${response.status}; put it there`);
  // Servers that do not know the type of .wasm files are common, so the response is not compiled as it comes.
  return WebAssembly.compile(await response.arrayBuffer());
}
