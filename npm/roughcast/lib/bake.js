// Bytes to bytes: documents and standalone maps.
import { backend, listFiles } from '#backend';
import { isGlb, stem } from './names.js';
import { MAP_SETTINGS, tomlSettings } from './settings.js';

/** Bakes the materials of a glTF document; bake.d.ts describes the arguments and the result. */
export async function bake(document, options) {
  const { runReport, report, ...baked } = await bakeWithSizes(document, options);
  // The command line counts copied files in its other members, and this function does not copy files.
  const { layers, textures } = report;
  const { version, settings } = runReport;
  return { ...baked, report: { version, settings, layers, textures } };
}

/**
 * Bakes as `bake` does, with all members of the backend's report, and with the report of the run. WebAssembly names the
 * outputs after `output`, if it is given, and records the document under its own name.
 */
export async function bakeWithSizes(document, options = {}, output = undefined) {
  const { name = 'model', files = {}, threads, onProgress, backend: kind } = options;
  const [bytes, settings] = [asBytes(document, 'document'), tomlSettings(options.settings)];
  const { bakeDocument } = await backend(kind);
  const { names } = await listFiles(bytes, threads);
  const beside = [];
  for (const path of names) {
    const file = typeof files === 'function' ? await files(path) : files[path];
    // The bake reports files that are missing, all at once.
    if (file) beside.push({ path, bytes: asBytes(file, path) });
  }
  const input = { path: `${name}.${isGlb(bytes) ? 'glb' : 'gltf'}`, bytes };
  const baked = await bakeDocument({ name, output, input, beside, settings, threads, onProgress });
  baked.files.sort((a, b) => (a.path < b.path ? -1 : 1));
  return { ...baked, copies: baked.copies.sort() };
}

/** Bakes a standalone normal or height map; bake.d.ts describes the arguments and the result. */
export async function bakeMap(image, options = {}) {
  const { name = 'map.png', output = `${stem(name)}.ktx2`, roughness, settings, threads, backend: kind, ...rest } =
    options;
  const files = [{ path: name, bytes: asBytes(image, 'image') }];
  if (roughness) files.push({ path: roughness.name ?? 'roughness.png', bytes: asBytes(roughness.image, 'roughness') });
  const named = tomlSettings(settings, MAP_SETTINGS);
  const { bakeImage } = await backend(kind);
  return bakeImage({ output, files, options: rest, settings: named, threads });
}

/** Returns `bytes`, which must be a Uint8Array. */
function asBytes(bytes, name) {
  if (bytes instanceof Uint8Array) return bytes;
  const remedy = 'read the file first, and wrap an ArrayBuffer by new Uint8Array(buffer)';
  throw new TypeError(`${name}: expected a Uint8Array, found ${bytes?.constructor?.name ?? bytes}; ${remedy}`);
}
