// The worker's side of a call with threads; threads.js is the other side. One worker answers the call, and the others
// are threads of its pool.
import { callModule, runThread } from './wasm.js';

/**
 * Does the work of a worker.
 *
 * @param {{module: WebAssembly.Module, memory: WebAssembly.Memory, call?: object, thread?: object}} work
 * @param {(message: object, transfer?: ArrayBuffer[]) => void} post sends a message to threads.js
 */
export async function work({ module, memory, call, thread }, post) {
  try {
    if (thread) return await runThread(module, memory, thread);
    const response = await callModule(module, call.header, call.files, {
      onProgress: (progress) => post({ progress }),
      memory,
      threads: call.threads,
      onSpawn: (spawn) => post({ spawn }),
    });
    post(
      { response },
      response.files.map(({ bytes }) => bytes.buffer),
    );
  } catch (error) {
    const isOutside = error.cause instanceof WebAssembly.RuntimeError && /out of bounds/.test(error.cause.message);
    post({ failure: { message: error.message, isOutside } });
  }
}
