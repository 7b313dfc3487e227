// Workers of browsers.

/**
 * Starts a worker.
 *
 * @param {(message: object) => void} received takes its messages
 * @param {(error: {message: string}) => void} failed
 */
export function startWorker(received, failed) {
  const worker = new Worker(new URL('./thread.browser.js', import.meta.url), { type: 'module' });
  worker.onmessage = ({ data }) => received(data);
  const missing = 'expected the worker lib/thread.browser.js, found none; serve it, or set threads: 1';
  worker.onerror = ({ message }) => failed({ message: message || missing });
  return { post: (message) => worker.postMessage(message), stop: () => worker.terminate() };
}
