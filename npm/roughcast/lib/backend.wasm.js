// The bake by WebAssembly, for a compiled module.
import { callModule } from './wasm.js';

/** Returns the functions of a backend for `module`. */
export function wasmBackend(module) {
  return {
    async bakeDocument({ name, input, beside, settings, onProgress }) {
      const header = { command: 'bake', stem: name, settings };
      const response = await callModule(module, header, [input, ...beside], onProgress);
      const [document, ...files] = response.files;
      return { document, files, copies: response.header.copies, report: response.header.report };
    },

    async bakeImage({ output, files, options, settings }) {
      const header = { command: 'map', heightScale: 0.05, ...options, output, settings };
      const response = await callModule(module, header, files);
      return { files: response.files, report: response.header.report };
    },

    async listFiles(document) {
      const response = await callModule(module, { command: 'files' }, [{ path: 'document', bytes: document }]);
      return response.header;
    },
  };
}
