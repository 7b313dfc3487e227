// The baked plane of fixtures/real, and materials of it that differ from the bake.
import { readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { EXTENSION } from './extension_reader.js';
import { REPEAT } from './extension_texture.js';
import { halfFloats } from './half_floats.js';
import { repository, roughcast } from './roughcast.js';

/** The plane as its glTF has it. `u` and `v` are the derivatives of the position by the texture coordinates. */
export const PLANE = {
  corner: [-1, 0, -1],
  u: [1, 0, 0],
  v: [0, 0, 1],
  repeats: 2,
  normal: [0, 1, 0],
  tangent: [1, 0, 0, 1],
  node: [1, 1, 1],
};

/** Members of an extension object without K. */
export const WITHOUT_K = {
  roughnessModel: undefined,
  roughnessTexture: undefined,
  roughnessMin: undefined,
  roughnessMax: undefined,
};

/**
 * Bakes the plane to half floats, with files that every loader reads unless `options` say otherwise. Returns its
 * document, its folder, and its textures as the reader takes them.
 */
export function bake(folder, model, options = ['--profile', 'both', '--gltf', 'dual']) {
  const output = path.join(folder, model);
  const target = ['--target', 'float', '--model', model, '--quiet'];
  roughcast('bake', path.join(repository, 'fixtures/real'), '-o', output, ...target, ...options);
  const gltf = JSON.parse(readFileSync(path.join(output, 'gravel.gltf'), 'utf8'));
  const levels = ({ uri }) => (uri.endsWith('.ktx2') ? halfFloats(path.join(output, decodeURIComponent(uri))) : null);
  const image = ({ source, extensions }) => gltf.images[extensions?.KHR_texture_basisu?.source ?? source];
  const textures = gltf.textures.map((texture) => ({ levels: levels(image(texture)), wrap: REPEAT }));
  return { gltf, output, textures };
}

/**
 * Returns the material of a bake with another base lobe, metalness and texture transforms, and other members. The base
 * lobe is that of the core material if `isCore`.
 */
export function material({ gltf }, { lobe, isCore, metalness = 1, transforms = [], members }) {
  const { extensions, normalTexture } = gltf.materials[0];
  const baseLobe = lobe ?? { roughnessFactor: 0.35 };
  const { anisotropy, ...core } = isCore ? baseLobe : {};
  const pyramid = { ...extensions[EXTENSION], ...members, baseLobe: isCore ? undefined : baseLobe };
  for (const [i, name] of ['offsetTexture', 'roughnessTexture'].entries()) {
    const [transform, info] = [transforms[Math.min(i, transforms.length - 1)], pyramid[name]];
    if (transform && info) pyramid[name] = { ...info, extensions: { KHR_texture_transform: transform } };
  }
  return {
    normalTexture,
    doubleSided: true,
    pbrMetallicRoughness: { ...core, baseColorFactor: [0.9, 0.5, 0.2, 1], metallicFactor: metalness },
    extensions: { [EXTENSION]: pyramid, KHR_materials_anisotropy: anisotropy },
  };
}

/** Returns a base lobe with textures of the core material. */
export function withTextures({ gltf }, lobe, names) {
  const { pbrMetallicRoughness, extensions } = gltf.materials[0];
  const all = { ...pbrMetallicRoughness, ...extensions.KHR_materials_anisotropy };
  const { metallicRoughnessTexture, anisotropyTexture } = Object.fromEntries(names.map((name) => [name, all[name]]));
  const anisotropy = lobe.anisotropy && { ...lobe.anisotropy, anisotropyTexture };
  return JSON.parse(JSON.stringify({ ...lobe, metallicRoughnessTexture, anisotropy }));
}

/** Writes a document of a bake with another material and another plane. Returns the name of the file. */
export function write({ gltf, output }, changed, { tangent, node }) {
  const document = structuredClone(gltf);
  document.materials = [changed];
  document.extensionsUsed.push('KHR_texture_transform');
  document.samplers[0].wrapS = document.samplers[0].wrapT = REPEAT;
  document.nodes[0].scale = node;
  if (!tangent) delete document.meshes[0].primitives[0].attributes.TANGENT;
  writeFileSync(path.join(output, 'changed.gltf'), JSON.stringify(document));
  return 'changed.gltf';
}
