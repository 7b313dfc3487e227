// The backend of browsers: WebAssembly, fetched once from beside this file.
import { wasmBackend } from './backend.wasm.js';

let loaded;

/** Returns the backend. */
export async function backend(kind = 'wasm') {
  if (kind !== 'wasm') throw new Error(`expected the backend wasm, found ${kind}; browsers have no other`);
  loaded ??= load();
  return loaded;
}

/** Returns the names of the files that a document refers to. */
export async function listFiles(document) {
  return (await backend()).listFiles(document);
}

async function load() {
  const url = new URL('../roughcast.wasm', import.meta.url);
  const response = await fetch(url);
  if (!response.ok)
    throw new Error(`expected the WebAssembly module at ${url}, found ${response.status}; put it there`);
  // Servers that do not know the type of .wasm files are common, so the response is not compiled as it comes.
  return wasmBackend(await WebAssembly.compile(await response.arrayBuffer()));
}
