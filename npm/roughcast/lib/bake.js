// Bytes to bytes: documents and standalone maps.
import { backend, listFiles } from '#backend';
import { isGlb, stem } from './names.js';
import { tomlSettings } from './settings.js';

/** Bakes the materials of a glTF document; bake.d.ts describes the arguments and the result. */
export async function bake(document, options) {
  const { runReport, report, ...baked } = await bakeWithSizes(document, options);
  // The command line counts copied files in its other members, and this function does not copy files.
  const { layers, textures } = report;
  const { version, settings } = runReport;
  return { ...baked, report: { version, settings, layers, textures } };
}

/** Bakes as `bake` does, with all members of the backend's report, and with the report of the run. */
export async function bakeWithSizes(document, options = {}) {
  const { name = 'model', files = {}, settings = {}, threads, onProgress, backend: kind } = options;
  const { bakeDocument } = await backend(kind);
  const { names } = await listFiles(document, threads);
  const beside = [];
  for (const path of names) {
    const bytes = typeof files === 'function' ? await files(path) : files[path];
    // The bake reports files that are missing, all at once.
    if (bytes) beside.push({ path, bytes: asBytes(bytes, path) });
  }
  const input = { path: `${name}.${isGlb(document) ? 'glb' : 'gltf'}`, bytes: asBytes(document, name) };
  const baked = await bakeDocument({ name, input, beside, settings: tomlSettings(settings), threads, onProgress });
  baked.files.sort((a, b) => (a.path < b.path ? -1 : 1));
  return { ...baked, copies: baked.copies.sort() };
}

/** Bakes a standalone normal or height map; bake.d.ts describes the arguments and the result. */
export async function bakeMap(image, options = {}) {
  const { name = 'map.png', output = `${stem(name)}.ktx2`, roughness, settings, threads, backend: kind, ...rest } =
    options;
  const { bakeImage } = await backend(kind);
  const files = [{ path: name, bytes: asBytes(image, name) }];
  if (roughness) files.push({ path: roughness.name ?? 'roughness.png', bytes: asBytes(roughness.image, 'roughness') });
  return bakeImage({ output, files, options: rest, settings: tomlSettings(settings), threads });
}

/** Checks that `bytes` is a Uint8Array. */
function asBytes(bytes, name) {
  if (bytes instanceof Uint8Array) return bytes;
  throw new TypeError(`${name}: expected a Uint8Array, found ${bytes?.constructor?.name ?? bytes}`);
}
