// Calls of the WebAssembly module. Each call has an instance of its own: the memory of an instance never shrinks, and a
// panic leaves an instance in an unknown state.
import { decodeResponse, encodeRequest } from './message.js';

/**
 * Sends a request to a new instance of `module`.
 *
 * @param {WebAssembly.Module} module
 * @param {object} header
 * @param {{path: string, bytes: Uint8Array}[]} files
 * @param {(share: number) => void} [onProgress]
 */
export async function callModule(module, header, files, onProgress = () => {}) {
  let memory;
  let panic;
  const roughcast = {
    progress: onProgress,
    panicked: (address, length) => {
      panic = new TextDecoder().decode(new Uint8Array(memory.buffer, address, length));
    },
  };
  const { exports } = await WebAssembly.instantiate(module, { roughcast });
  memory = exports.memory;
  try {
    const request = write(exports, encodeRequest(header, files));
    // Addresses are unsigned, and JavaScript sees them as signed.
    const address = exports.call(...request) >>> 0;
    const response = decodeResponse(memory.buffer, address);
    if (response.header.error !== undefined) throw new Error(response.header.error);
    return response;
  } catch (error) {
    throw error instanceof WebAssembly.RuntimeError ? described(error, panic, memory) : error;
  }
}

/** Writes the parts of a request into the memory of an instance. Returns its address and length. */
function write(exports, parts) {
  const length = parts.reduce((sum, part) => sum + part.byteLength, 0);
  const address = exports.allocate(length) >>> 0;
  let at = address;
  for (const part of parts) {
    new Uint8Array(exports.memory.buffer).set(part, at);
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
