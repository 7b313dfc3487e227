import assert from 'node:assert/strict';
import { mkdirSync, symlinkSync, writeFileSync } from 'node:fs';
import http from 'node:http';
import net from 'node:net';
import path from 'node:path';
import test from 'node:test';
import { serve } from '../server.js';
import { temporary } from './roughcast.js';

/** Makes a folder to be served, beside a file that must not be. */
async function served(t) {
  const folder = temporary(t);
  const asset = path.join(folder, 'asset');
  mkdirSync(path.join(asset, 'textures'), { recursive: true });
  writeFileSync(path.join(asset, 'a b.gltf'), '{}');
  writeFileSync(path.join(asset, 'textures', 'c.ktx2'), 'texels');
  writeFileSync(path.join(folder, 'secret'), 'secret');
  mkdirSync(path.join(folder, 'asset-too'));
  writeFileSync(path.join(folder, 'asset-too', 'secret'), 'secret');
  symlinkSync(path.join(folder, 'secret'), path.join(asset, 'link'));
  symlinkSync(folder, path.join(asset, 'up'));
  symlinkSync(path.join(folder, 'asset-too', 'secret'), path.join(asset, 'sibling'));
  symlinkSync(path.join(asset, 'textures', 'c.ktx2'), path.join(asset, 'inside'));
  const server = await serve({ asset });
  t.after(server.close);
  return server.url;
}

/** Sends a request whose path is not normalised. */
const get = (url, target, { method = 'GET', host } = {}) =>
  new Promise((resolve, reject) => {
    const { hostname, port } = new URL(url);
    const headers = host ? { host } : {};
    const request = http.request({ hostname, port, path: target, method, headers }, (response) => {
      let body = '';
      response.on('data', (part) => (body += part));
      response.on('end', () => resolve({ status: response.statusCode, type: response.headers['content-type'], body }));
    });
    request.on('error', reject);
    request.end();
  });

test('serves files of the folder', async (t) => {
  const url = await served(t);
  assert.deepEqual(await get(url, '/asset/a%20b.gltf?x=1'), { status: 200, type: 'model/gltf+json', body: '{}' });
  assert.deepEqual(await get(url, '/asset/textures/c.ktx2'), { status: 200, type: 'image/ktx2', body: 'texels' });
  assert.equal((await get(url, '/asset/inside')).body, 'texels');
  assert.deepEqual((await get(url, '/asset/inside', { method: 'HEAD' })).body, '');
});

test('serves nothing else', async (t) => {
  const url = await served(t);
  const paths = [
    '/',
    '/asset',
    '/asset/',
    '/asset/textures',
    '/asset/none',
    '/other/a',
    '/secret',
    '/../secret',
    '/asset/../secret',
    '/asset/textures/../../secret',
    '/asset/%2e%2e/secret',
    '/asset/..%2fsecret',
    '/asset/%2e%2e%2fsecret',
    '/asset/..%5csecret',
    '/asset//../secret',
    '/asset/./../secret',
    '/asset/link',
    '/asset/up/secret',
    '/asset/up/asset-too/secret',
    '/asset/sibling',
    '/asset/%00',
    '/asset/a%20b.gltf%00.png',
    '/asset/%',
    '/asset/%ff',
    '/__proto__/secret',
    '/asset-too/secret',
    '*',
  ];
  for (const path of paths) {
    const { status, body } = await get(url, path);
    assert.equal(status, 404, `${path}: ${body}`);
    assert.doesNotMatch(body, /secret|texels/);
  }
});

test('refuses other methods and other names of this machine', async (t) => {
  const url = await served(t);
  for (const method of ['POST', 'PUT', 'DELETE'])
    assert.equal((await get(url, '/asset/inside', { method })).status, 405);
  for (const host of ['example.com', 'example.com:80', '127.0.0.1.example.com', 'localhost.example.com:1']) {
    assert.equal((await get(url, '/asset/inside', { host })).status, 403);
  }
});

test('listens to this machine only', async (t) => {
  const { port } = new URL(await served(t));
  const others = Object.values((await import('node:os')).networkInterfaces())
    .flat()
    .filter((i) => !i.internal && i.family === 'IPv4');
  for (const { address } of others) {
    await assert.rejects(
      new Promise((resolve, reject) =>
        net
          .connect({ host: address, port, timeout: 2000 }, resolve)
          .on('error', reject)
          .on('timeout', () => reject(new Error('timeout'))),
      ),
    );
  }
});
