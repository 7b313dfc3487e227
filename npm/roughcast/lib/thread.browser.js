// A worker of browsers.
import { work } from './thread.js';

addEventListener('message', ({ data }) => work(data, (reply, transfer) => postMessage(reply, { transfer })));
