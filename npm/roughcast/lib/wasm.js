// Calls of the WebAssembly module on the calling thread. Each call has an instance of its own: the memory of an
// instance never shrinks, and a panic leaves an instance in an unknown state.
import { decodeResponse, encodeRequest, textAt } from './message.js';

/**
 * Sends a request to a new instance of `module`.
 *
 * @param {WebAssembly.Module} module
 * @param {object} header
 * @param {{path: string, bytes: Uint8Array}[]} files
 * @param {object} [options]
 * @param {(share: number) => void} [options.onProgress]
 * @param {WebAssembly.Memory} [options.memory] the memory, if the module imports one
 * @param {number} [options.threads]
 * @param {(thread: {address: number, stack: number, locals: number}) => void} [options.onSpawn] starts a worker that
 * calls `runThread`
 * @returns {Promise<{header: object, files: {path: string, bytes: Uint8Array}[]}>}
 */
export async function callModule(module, header, files, { onProgress, memory, threads = 1, onSpawn } = {}) {
  const started = await instantiate(module, memory, {
    progress: onProgress ?? (() => {}),
    spawn: (address) => onSpawn({ address, ...placeOfThread(started.exports) }),
  });
  return started.attempt((exports) => {
    const request = write(started.memory, exports, encodeRequest(header, files));
    // Addresses are unsigned, and JavaScript sees them as signed.
    const address = exports.call(...request, threads) >>> 0;
    const response = decodeResponse(started.memory.buffer, address);
    if (response.header.error !== undefined) throw new Error(response.header.error);
    return response;
  });
}

/** Works in an instance of its own for the thread pool of a call, until the call has its result. */
export async function runThread(module, memory, { address, stack, locals }) {
  const { attempt } = await instantiate(module, memory, { progress() {}, spawn() {} });
  attempt((exports) => {
    exports.__stack_pointer.value = stack;
    exports.__wasm_init_tls(locals);
    exports.run_thread(address);
  });
}

/** Makes an instance. Its `attempt` calls a function with the exports, and says why the module has failed. */
async function instantiate(module, shared, functions) {
  let panic;
  const panicked = (address, length) => (panic = textAt(memory.buffer, address, length));
  const imports = { roughcast: { ...functions, panicked }, env: { memory: shared } };
  const { exports } = await WebAssembly.instantiate(module, imports);
  const memory = shared ?? exports.memory;
  const attempt = (work) => {
    try {
      return work(exports);
    } catch (error) {
      throw error instanceof WebAssembly.RuntimeError ? described(error, panic, memory) : error;
    }
  };
  return { exports, memory, attempt };
}

/** Bytes of the stack of a thread, as many as build.sh gives to the first one. */
const STACK = 8 * 2 ** 20;

/** Allocates what a thread needs: the end of its stack, which grows downwards, and its thread-local memory. */
function placeOfThread(exports) {
  const [size, alignment] = [exports.__tls_size.value, exports.__tls_align.value];
  const aligned = (address, to) => (address >>> 0) - ((address >>> 0) % to);
  const stack = aligned(exports.allocate(STACK) + STACK, 16);
  const locals = aligned(exports.allocate(size + alignment) + alignment, alignment);
  return { stack, locals };
}

/** Writes the parts of a request into the memory of an instance. Returns its address and length. */
function write(memory, exports, parts) {
  const length = parts.reduce((sum, part) => sum + part.byteLength, 0);
  const address = exports.allocate(length) >>> 0;
  let at = address;
  for (const part of parts) {
    new Uint8Array(memory.buffer).set(part, at);
    at += part.byteLength;
  }
  return [address, length];
}

/** Memory above which a trap is probably a refused allocation: WebAssembly has 4 GiB. */
const NEARLY_ALL = 3 * 2 ** 30;

function described(error, panic, memory) {
  const what =
    memory.buffer.byteLength > NEARLY_ALL
      ? 'expected to need less than 4 GiB, the limit of WebAssembly; bake smaller textures or use the native tool'
      : `the WebAssembly module failed; please report this: ${panic ?? error.message}`;
  return new Error(what, { cause: error });
}
