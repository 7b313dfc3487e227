// Times a bake by the native tool and by WebAssembly: `node bench.js [model.glb] [--runs 3]`. Needs $ROUGHCAST or a
// built tool, the WebAssembly modules, and Chromium.
//
// Without a model, bakes a material of 2048 x 2048 texels: a normal map of scratches and noise, and an ORM texture.
// Prints medians in seconds. `cpu` is the time on processors, which other programs of the machine change less.
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import process from 'node:process';
import { parseArgs } from 'node:util';
import { Document, NodeIO } from '@gltf-transform/core';
import { chromium } from 'playwright-core';
import { PNG } from 'pngjs';
import { serve } from '../plugins/three/server.js';
import { binary, noBinary, noModule, npm, run } from './test/common.js';

const SIZE = 2048;

/** Numbers of threads of WebAssembly. */
const THREADS = [1, 2];
const title = (threads) => (threads === 1 ? 'one thread' : `${threads} threads`);

const { values, positionals } = parseArgs({
  options: { runs: { type: 'string', default: '3' } },
  allowPositionals: true,
});
const work = mkdtempSync(path.join(os.tmpdir(), 'roughcast-bench-'));

/** Returns a PNG whose texels `texel` returns as [red, green, blue]. */
function png(texel) {
  const image = new PNG({ width: SIZE, height: SIZE });
  for (let y = 0; y < SIZE; y++) {
    for (let x = 0; x < SIZE; x++) image.data.set([...texel(x, y), 255], 4 * (y * SIZE + x));
  }
  return PNG.sync.write(image, { colorType: 2, deflateLevel: 6 });
}

/** Returns a number in [0, 1) that depends on whole numbers only. */
function noise(...numbers) {
  let hash = 2166136261;
  for (const number of numbers) hash = Math.imul(hash ^ number, 16777619) ^ (hash >>> 13);
  return (hash >>> 0) / 2 ** 32;
}

async function material() {
  const document = new Document();
  document.createBuffer();
  const texture = (image) => document.createTexture().setImage(image).setMimeType('image/png');
  const slope = (x, y) => 0.5 * (noise(y >> 1, 1) - 0.5) + 0.3 * (noise(x >> 2, y >> 2, 2) - 0.5);
  const normal = (x, y) => {
    const [u, v] = [0.3 * slope(y, x), slope(x, y)];
    return [-u, -v, 1].map((c) => Math.round(127.5 + (127.5 * c) / Math.hypot(u, v, 1)));
  };
  document
    .createMaterial('scratches')
    .setNormalTexture(texture(png(normal)))
    .setMetallicRoughnessTexture(texture(png((x, y) => [255, 60 + 80 * noise(x >> 5, y >> 5, 3), 255])));
  return new NodeIO().writeBinary(document);
}

const median = (numbers) => [...numbers].sort((a, b) => a - b)[numbers.length >> 1];

/** Runs a command. Returns its seconds on the clock and, with `cpu`, on processors. */
function shell(command, environment = {}) {
  const script = `TIMEFORMAT='%R %U'; time ${command} -o '${work}/out' --glb --quiet`;
  const { status, stderr } = spawnSync('bash', ['-c', script], {
    env: { ...process.env, ...environment },
    encoding: 'utf8',
  });
  if (status !== 0) throw new Error(stderr);
  const [wall, cpu] = stderr.trim().split('\n').at(-1).split(' ').map(Number);
  return { wall, cpu };
}

/** Bakes in the worker that the page has. Returns the seconds. */
function bakeInWorker(threads) {
  const { model, worker } = globalThis;
  return new Promise((resolve, reject) => {
    worker.onmessage = ({ data }) => {
      if (data.baked) resolve(data.baked.seconds);
      if (data.error) reject(new Error(data.error));
    };
    worker.postMessage({ document: model, name: 'model', settings: {}, threads });
  });
}

/** Returns the seconds that Chromium's processes have had on processors. */
async function processorSeconds(session) {
  const { processInfo } = await session.send('SystemInfo.getProcessInfo');
  return processInfo.reduce((sum, { cpuTime }) => sum + cpuTime, 0);
}

/**
 * Returns the bakes in the worker of the page by numbers of threads: seconds on the clock, and of Chromium's processes.
 */
async function inChromium(file, runs, numbers) {
  run(process.execPath, [path.join(npm, 'make-page.js'), '--out', path.join(work, 'page')]);
  const server = await serve({ page: path.join(work, 'page') }, { isIsolated: true });
  const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox'],
  });
  try {
    const page = await browser.newPage();
    // A page without three.js: only the worker runs.
    await page.goto(`${server.url}/page/worker.js`);
    writeFileSync(path.join(work, 'page/model.glb'), readFileSync(file));
    await page.evaluate(async (base) => {
      globalThis.model = new Uint8Array(await (await fetch(`${base}/model.glb`)).arrayBuffer());
      globalThis.worker = new Worker(`${base}/worker.js`, { type: 'module' });
    }, `${server.url}/page`);
    const session = await browser.newBrowserCDPSession();
    const times = numbers.map(() => []);
    for (let i = 0; i < runs; i++) {
      for (const [index, threads] of numbers.entries()) {
        const before = await processorSeconds(session);
        const wall = await page.evaluate(bakeInWorker, threads);
        times[index].push({ wall, cpu: (await processorSeconds(session)) - before });
      }
    }
    return times;
  } finally {
    await browser.close();
    await server.close();
  }
}

try {
  if (noBinary || noModule) throw new Error(`bench.js ${noBinary || noModule}`);
  const file = positionals[0] ?? path.join(work, 'model.glb');
  if (!positionals[0]) writeFileSync(file, await material());
  const tool = path.join(npm, 'roughcast/bin/roughcast.js');
  const commands = {
    'native, one thread': [`'${binary}' bake '${file}' --threads 1 --no-config`],
    'native, all threads': [`'${binary}' bake '${file}' --no-config`],
  };
  for (const threads of THREADS) {
    const command = `'${process.execPath}' '${tool}' bake '${file}' --no-config --threads ${threads}`;
    commands[`WebAssembly, Node, ${title(threads)}`] = [command, { ROUGHCAST_BACKEND: 'wasm' }];
  }
  const times = Object.fromEntries(Object.keys(commands).map((name) => [name, []]));
  // Turn by turn, so that other programs slow all of them down.
  for (let i = 0; i < Number(values.runs); i++) {
    for (const [name, [command, environment]] of Object.entries(commands))
      times[name].push(shell(command, environment));
  }
  for (const [index, runs] of (await inChromium(file, Number(values.runs), THREADS)).entries()) {
    times[`WebAssembly, Chromium, ${title(THREADS[index])}`] = runs;
  }
  for (const [name, runs] of Object.entries(times)) {
    const [wall, cpu] = ['wall', 'cpu'].map((key) => median(runs.map((time) => time[key])).toFixed(2));
    process.stdout.write(`${name.padEnd(36)} ${wall} s, cpu ${cpu} s\n`);
  }
} finally {
  rmSync(work, { recursive: true, force: true });
}
