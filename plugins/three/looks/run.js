// Bakes materials, draws them and measures the error of each variant.
import { copyFileSync, existsSync, mkdirSync, readdirSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { launch, open } from '../browser.js';
import { serve } from '../server.js';
import { example, repository, roughcast } from '../test/roughcast.js';

/**
 * Variants: three.js itself draws `portable`; `reflected` is anisotropic lobes with the reflections of
 * plugins/three/plugin.
 */
export const NAMES = ['plain', 'portable', 'reflected', 'pyramid'];
export const KINDS = ['plane', 'sphere'];
/** Distances in units of the radius of the sphere. The side of the plane is 4. */
export const DISTANCES = [3, 5, 8, 13, 21, 34];

/** Options of each bake; `reflected` draws `anisotropic`. $MODEL replaces the model of the preset. */
const BAKES = {
  portable: ['--engine', 'three', ...(process.env.MODEL ? ['--model', process.env.MODEL] : [])],
  anisotropic: [],
  pyramid: ['--engine', 'three', '--profile', 'pyramid'],
  both: ['--profile', 'both'],
};

const DATA = path.join(repository, '../shared/data/maps');
/** Standalone maps, with the roughness of a metal. */
const MAPS = {
  aluminium: ['aluminium_normal.png', 0.316],
  wool: ['wool_normal.png', 0.45],
  water: ['water_normals.png', 0.2],
};

/** Returns name and folder, with <name>.gltf, of the fixture and of the real materials that are there. */
export function materials(folder) {
  const all = [['brushed', path.join(repository, 'fixtures/brushed')]];
  for (const [name, [map, roughness]] of Object.entries(MAPS)) {
    if (existsSync(path.join(DATA, map)))
      all.push([name, wrapped(path.join(folder, `${name}-source`), name, map, roughness)]);
  }
  return all;
}

/** Writes a glTF of one triangle with a normal map. The page has its own planes and spheres. */
function wrapped(folder, name, map, roughness) {
  mkdirSync(folder);
  copyFileSync(path.join(DATA, map), path.join(folder, map));
  const corners = Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 1, 1, 1, 0, 0);
  const accessor = (byteOffset, type, more) => ({
    bufferView: 0,
    byteOffset,
    componentType: 5126,
    count: 3,
    type,
    ...more,
  });
  const gltf = {
    asset: { version: '2.0' },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, NORMAL: 1, TEXCOORD_0: 2 }, material: 0 }] }],
    materials: [
      { pbrMetallicRoughness: { metallicFactor: 1, roughnessFactor: roughness }, normalTexture: { index: 0 } },
    ],
    textures: [{ source: 0 }],
    images: [{ uri: map }],
    accessors: [accessor(0, 'VEC3', { min: [0, 0, 0], max: [1, 1, 0] }), accessor(36, 'VEC3'), accessor(72, 'VEC2')],
    bufferViews: [{ buffer: 0, byteLength: 96 }],
    buffers: [
      { byteLength: 96, uri: `data:application/octet-stream;base64,${Buffer.from(corners.buffer).toString('base64')}` },
    ],
  };
  writeFileSync(path.join(folder, `${name}.gltf`), JSON.stringify(gltf));
  return folder;
}

/** Returns name and folder of the materials in a folder: each is <name>/<name>.gltf. */
export function found(folder) {
  return readdirSync(folder)
    .sort()
    .map((name) => [name, path.join(folder, name)])
    .filter(([name, source]) => existsSync(path.join(source, `${name}.gltf`)));
}

/** Calls `use` with a page that has loaded the variants of each material: the original and `bakes`. */
export async function forEach(folder, chosen, use, bakes = BAKES) {
  const folders = Object.fromEntries(['looks', 'page', 'plugin'].map((name) => [name, path.join(example, name)]));
  const sources = Object.fromEntries(chosen.map(([name, source]) => [`source-${name}`, source]));
  const server = await serve({
    ...folders,
    ...sources,
    three: path.join(example, 'node_modules/three'),
    baked: folder,
  });
  const browser = await launch();
  try {
    for (const [name, source] of chosen) {
      mkdirSync(path.join(folder, name), { recursive: true });
      for (const [variant, options] of Object.entries(bakes)) {
        roughcast('bake', source, '-o', path.join(folder, name, variant), ...options, '--gltf', 'strict', '--quiet');
      }
      const page = await open(browser, `${server.url}/looks/looks.html`);
      await page.waitForFunction('window.ready');
      const baked = Object.keys(bakes).map((variant) => [variant, `/baked/${name}/${variant}/${name}.gltf`]);
      const urls = { original: `/source-${name}/${name}.gltf`, ...Object.fromEntries(baked) };
      if (urls.anisotropic) urls.reflected = urls.anisotropic;
      await page.evaluate((u) => window.load(u), urls);
      await use(name, page);
      await page.context().close();
    }
  } finally {
    await browser.close();
    await server.close();
  }
}

/** Returns [name, operations, fetches] of each way to shade. */
export async function costs() {
  const modules = ['three', '@babylonjs'].map((name) => [name, path.join(example, 'node_modules', name)]);
  const folders = ['looks', 'plugin'].map((name) => [name, path.join(example, name)]);
  const server = await serve(Object.fromEntries([...modules, ...folders]));
  const browser = await launch();
  try {
    const page = await open(browser, `${server.url}/looks/cost.html`);
    await page.waitForFunction('window.ready');
    return await page.evaluate(() => window.costs());
  } finally {
    await browser.close();
    await server.close();
  }
}
