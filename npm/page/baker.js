// Bakes in a worker. A new bake ends the one that runs.

export class Baker {
  #worker = null;
  #stop = null;

  /**
   * Bakes the bytes of a .glb.
   *
   * @param {Uint8Array} document
   * @param {string} name of the file without its extension
   * @param {object} settings
   * @param {(share: number) => void} onProgress
   * @returns {Promise<{bytes: Uint8Array, report: object, seconds: number} | null>} null if another bake began
   */
  bake(document, name, settings, onProgress) {
    this.#stop?.();
    this.#worker ??= new Worker(new URL('worker.js', import.meta.url), { type: 'module' });
    const worker = this.#worker;
    return new Promise((resolve, reject) => {
      const end = (settle, value) => {
        this.#stop = null;
        worker.onmessage = null;
        settle(value);
      };
      this.#stop = () => {
        worker.terminate();
        this.#worker = null;
        end(resolve, null);
      };
      worker.onmessage = ({ data }) => {
        if (data.progress !== undefined) onProgress(data.progress);
        else if (data.error !== undefined) end(reject, new Error(data.error));
        else end(resolve, data.baked);
      };
      worker.onerror = (event) => end(reject, new Error(event.message || 'the worker cannot be loaded'));
      worker.postMessage({ document, name, settings });
    });
  }
}
