// A read-only web server of chosen folders, on the loopback interface and a free port. The native tool has the same in
// `crates/pipeline/src/viewer`.
import { createReadStream } from 'node:fs';
import { realpath, stat } from 'node:fs/promises';
import http from 'node:http';
import path from 'node:path';

const TYPES = {
  '.css': 'text/css',
  '.gltf': 'model/gltf+json',
  '.glb': 'model/gltf-binary',
  '.html': 'text/html',
  '.jpg': 'image/jpeg',
  '.jpeg': 'image/jpeg',
  '.js': 'text/javascript',
  '.json': 'application/json',
  '.ktx2': 'image/ktx2',
  '.mjs': 'text/javascript',
  '.png': 'image/png',
  '.svg': 'image/svg+xml',
  '.wasm': 'application/wasm',
  '.webp': 'image/webp',
};

/** What makes a page cross-origin isolated. Workers need the second one, too. */
const ISOLATION = new Map([
  ['cross-origin-opener-policy', 'same-origin'],
  ['cross-origin-embedder-policy', 'require-corp'],
]);

/**
 * Serves folders by the first part of the path: { three: '/a/folder' } is /three/. A link that leads out of its folder
 * is not found. Pages that listen to /events get an event from each `reportBake`. With `isIsolated`, pages are
 * cross-origin isolated, so that their workers can share memory.
 *
 * @returns {Promise<{url: string, reportBake: () => void, close: () => Promise<void>}>}
 */
export async function serve(folders, { isIsolated = false } = {}) {
  const roots = new Map();
  for (const [name, folder] of Object.entries(folders)) roots.set(name, await realpath(folder));
  const listeners = new Set();
  const server = http.createServer((request, response) => {
    if (isIsolated) response.setHeaders(ISOLATION);
    answer(roots, listeners, request, response).catch(() => fail(response, 500));
  });
  await new Promise((resolve, reject) => {
    server.once('error', reject);
    server.listen(0, '127.0.0.1', resolve);
  });
  return {
    url: `http://127.0.0.1:${server.address().port}`,
    reportBake: () => listeners.forEach((response) => response.write('data: baked\n\n')),
    close: () => new Promise((resolve) => server.close(resolve) && server.closeAllConnections()),
  };
}

async function answer(roots, listeners, request, response) {
  // A foreign host name for this address would let pages of that site read the files (DNS rebinding).
  if (!/^(127\.0\.0\.1|localhost)(:\d+)?$/.test(request.headers.host ?? '')) return fail(response, 403);
  if (request.method !== 'GET' && request.method !== 'HEAD') return fail(response, 405);
  if (request.method === 'GET' && request.url === '/events') return listen(listeners, response);
  const file = await find(roots, request.url);
  if (file === null) return fail(response, 404);
  response.writeHead(200, {
    'content-type': TYPES[path.extname(file.name).toLowerCase()] ?? 'application/octet-stream',
    'content-length': file.size,
    'cache-control': 'no-store',
    'x-content-type-options': 'nosniff',
    'cross-origin-resource-policy': 'same-origin',
  });
  if (request.method === 'HEAD') return response.end();
  createReadStream(file.name)
    .on('error', () => response.destroy())
    .pipe(response);
}

/** Sends server-sent events until the page is closed. */
function listen(listeners, response) {
  response.writeHead(200, { 'content-type': 'text/event-stream', 'cache-control': 'no-store' });
  response.flushHeaders();
  listeners.add(response);
  response.on('close', () => listeners.delete(response));
}

/** Returns the file that a URL names, or null. */
async function find(roots, url) {
  let parts;
  try {
    parts = url.split(/[?#]/, 1)[0].split('/').slice(1).map(decodeURIComponent);
  } catch {
    return null;
  }
  const root = roots.get(parts.shift());
  if (root === undefined || parts.some((part) => /[/\\\0]/.test(part) || part === '..')) return null;
  try {
    const name = await realpath(path.join(root, ...parts));
    const found = await stat(name);
    return found.isFile() && name.startsWith(root + path.sep) ? { name, size: found.size } : null;
  } catch {
    return null;
  }
}

function fail(response, status) {
  if (response.headersSent) return response.destroy();
  response.writeHead(status, { 'content-type': 'text/plain' });
  response.end(`${status} ${http.STATUS_CODES[status]}\n`);
}
