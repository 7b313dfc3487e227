// A worker of Node.
import { parentPort } from 'node:worker_threads';
import { work } from './thread.js';

parentPort.on('message', (message) => work(message, (reply, transfer) => parentPort.postMessage(reply, transfer)));
