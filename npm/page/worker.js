// Bakes in a thread of its own.
import { bake } from './roughcast/lib/bake.js';

addEventListener('message', async ({ data: { document, name, settings, threads } }) => {
  try {
    const onProgress = (share) => postMessage({ progress: share });
    const started = performance.now();
    const baked = await bake(document, { name, settings, threads, onProgress });
    const seconds = (performance.now() - started) / 1e3;
    postMessage({ baked: { bytes: baked.document.bytes, report: baked.report, seconds } }, [
      baked.document.bytes.buffer,
    ]);
  } catch (error) {
    postMessage({ error: error.message });
  }
});
