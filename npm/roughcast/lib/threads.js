// Calls of the WebAssembly module for shared memory. All threads of a call are workers: the calling thread must stay
// free to see that a worker has failed, since the others would wait for it for ever.
import { startWorker } from '#worker';

/** Pages of 64 KiB that build.sh declares: those that the memory has at first, and the most that it may have. */
const [INITIAL, MAXIMUM] = [256, 65536];

/** Returns a memory for one call, which threads can share. */
export const sharedMemory = () => new WebAssembly.Memory({ initial: INITIAL, maximum: MAXIMUM, shared: true });

/**
 * Sends a request to the module on `threads` threads.
 *
 * @param {WebAssembly.Module} module
 * @param {object} header
 * @param {{path: string, bytes: Uint8Array}[]} files
 * @param {number} threads
 * @param {(share: number) => void} [onProgress]
 * @returns {Promise<{header: object, files: {path: string, bytes: Uint8Array}[]}>}
 */
export async function callThreads(module, header, files, threads, onProgress) {
  try {
    return await callOnce(module, header, files, threads, onProgress);
  } catch (error) {
    // Chromium and Node check atomic instructions against a size of the memory that may be out of date on a thread when
    // another one has made the memory grow. Such a thread traps, and nothing is known to be wrong.
    if (threads === 1 || !error.isOutside) throw error;
    return callOnce(module, header, files, 1, onProgress);
  }
}

async function callOnce(module, header, files, threads, onProgress) {
  const memory = sharedMemory();
  const workers = [];
  try {
    return await new Promise((resolve, reject) => {
      const failed = ({ message, isOutside }) => reject(Object.assign(new Error(message), { isOutside }));
      const received = ({ progress, spawn, response, failure }) => {
        if (spawn) idle.pop().post({ module, memory, thread: spawn });
        else if (response) resolve(response);
        else if (failure) failed(failure);
        else onProgress?.(progress);
      };
      for (let i = 0; i < threads; i++) workers.push(startWorker(received, failed));
      const [first, ...idle] = workers;
      first.post({ module, memory, call: { header, files, threads } });
    });
  } finally {
    // Workers are not kept: with them goes the memory, which never shrinks.
    for (const worker of workers) worker.stop();
  }
}
