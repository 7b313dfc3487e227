// Workers of Node.
import { Worker } from 'node:worker_threads';

/**
 * Starts a worker.
 *
 * @param {(message: object) => void} received takes its messages
 * @param {(error: {message: string}) => void} failed
 */
export function startWorker(received, failed) {
  const worker = new Worker(new URL('./thread.node.js', import.meta.url));
  worker.on('message', received);
  worker.on('error', failed);
  return { post: (message) => worker.postMessage(message), stop: () => worker.terminate() };
}
