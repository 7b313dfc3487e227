// The bake by WebAssembly.
import { callThreads, sharedMemory } from './threads.js';
import { callModule } from './wasm.js';

/** The modules: for a memory of one thread, and for a memory that threads share. */
const [SINGLE, SHARED] = ['roughcast.wasm', 'roughcast.threads.wasm'];

/** The most threads that a bake starts by itself: each worker takes time and memory to start. */
const MOST = 16;

/** The most threads that can be asked for, as with the native tool. */
const LIMIT = 64;

/**
 * Returns the functions of a backend.
 *
 * @param {object} system
 * @param {(file: string) => Promise<WebAssembly.Module>} system.load compiles a module
 * @param {boolean} system.canShare whether workers can share memory; without it a bake has one thread
 * @param {number} system.processors
 */
export function wasmBackend({ load, canShare, processors }) {
  const modules = {};

  /** Loads a module once, or again after a failure. */
  function module(file) {
    modules[file] ??= load(file).catch((error) => {
      delete modules[file];
      throw error;
    });
    return modules[file];
  }

  /** Returns how many threads a call has. */
  function count(threads = 0) {
    if (!Number.isInteger(threads) || threads < 0 || threads > LIMIT) {
      throw new RangeError(`threads: expected a whole number from 0 to ${LIMIT}, found ${threads}`);
    }
    return canShare ? threads || Math.min(processors, MOST) : 1;
  }

  async function call(header, files, { threads, onProgress }) {
    const number = count(threads);
    if (number === 1) return callModule(await module(SINGLE), header, files, { onProgress });
    return callThreads(await module(SHARED), header, files, number, onProgress);
  }

  /** Calls on this thread the module that a bake with `threads` threads uses, so that no other one is loaded. */
  async function ask(header, files, threads) {
    const isSingle = count(threads) === 1;
    const options = isSingle ? {} : { memory: sharedMemory() };
    return (await callModule(await module(isSingle ? SINGLE : SHARED), header, files, options)).header;
  }

  return {
    /**
     * Returns the report of a run with these settings, without assets, and the note that it gets if some lobes are
     * anisotropic, or null.
     */
    async startRun(settings, threads) {
      const { report, onAnisotropy } = await ask({ command: 'run', settings }, [], threads);
      return { report, onAnisotropy };
    },

    async bakeDocument({ name, output, input, beside, settings, threads, onProgress }) {
      const header = { command: 'bake', stem: name, output, settings };
      const response = await call(header, [input, ...beside], { threads, onProgress });
      const [document, ...files] = response.files;
      const { copies, run: runReport, report } = response.header;
      return { document, files, copies, runReport, report };
    },

    async bakeImage({ output, files, options, settings, threads }) {
      const header = { command: 'map', heightScale: 0.05, ...options, output, settings };
      const response = await call(header, files, { threads });
      return { files: response.files, report: response.header.report };
    },

    /** Lists the files that a document names, by the module that a bake with `threads` threads uses. */
    async listFiles(document, threads) {
      return ask({ command: 'files' }, [{ path: 'document', bytes: document }], threads);
    },
  };
}
