// Reads what the tables compare of a .gltf or .glb file: its JSON, and the image that a material shows in each slot.
import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import path from 'node:path';

/** The vendor extension of the pyramid profile. */
export const PYRAMID = 'ROUGHCAST_materials_roughness_pyramid';

/** The extensions that replace the `source` of a texture. */
const SOURCES = ['KHR_texture_basisu', 'EXT_texture_webp', 'EXT_texture_avif'];

/** Signatures of image formats. */
const FORMATS = [
  ['KTX2', 0, Buffer.from([0xab, 0x4b, 0x54, 0x58, 0x20, 0x32, 0x30])],
  ['PNG', 0, Buffer.from([0x89, 0x50, 0x4e, 0x47])],
  ['JPEG', 0, Buffer.from([0xff, 0xd8])],
  ['WebP', 8, Buffer.from('WEBP')],
  ['AVIF', 8, Buffer.from('avif')],
];

/**
 * Reads a file.
 *
 * @returns {{json: object, image: (texture: {index: number}) => {format: string, digest: string, source: string}}}
 * The JSON, and a function that describes the image of a textureInfo: its format, the digest of its bytes, and the
 * extension that names the image, or "source".
 */
export function read(file) {
  const bytes = readFileSync(file);
  const isGlb = bytes.toString('latin1', 0, 4) === 'glTF';
  const length = isGlb ? bytes.readUInt32LE(12) : bytes.length;
  const start = isGlb ? 20 : 0;
  const json = JSON.parse(bytes.toString('utf8', start, start + length));
  // The chunk after the JSON has a header of 8 bytes.
  const chunk = isGlb ? bytes.subarray(start + length + 8) : null;
  const load = (uri) => {
    if (uri.startsWith('data:')) return Buffer.from(uri.slice(uri.indexOf(',') + 1), 'base64');
    return readFileSync(path.join(path.dirname(file), decodeURIComponent(uri)));
  };
  const content = ({ uri, bufferView }) => {
    if (uri !== undefined) return load(uri);
    const { buffer, byteOffset = 0, byteLength } = json.bufferViews[bufferView];
    const data = json.buffers[buffer].uri === undefined ? chunk : load(json.buffers[buffer].uri);
    return data.subarray(byteOffset, byteOffset + byteLength);
  };
  const image = ({ index }) => {
    const { source, extensions = {} } = json.textures[index];
    const extension = SOURCES.find((name) => extensions[name] !== undefined);
    const data = content(json.images[extension ? extensions[extension].source : source]);
    const format = FORMATS.find(([, at, signature]) => data.subarray(at, at + signature.length).equals(signature));
    return {
      format: format?.[0] ?? 'unknown',
      digest: createHash('sha256').update(data).digest('hex'),
      source: extension ?? 'source',
    };
  };
  return { json, image };
}

/** Returns the textureInfos of a material by slot; absent slots are undefined. */
export function slots(material) {
  const pyramid = material.extensions?.[PYRAMID];
  return {
    normal: material.normalTexture,
    roughness: material.pbrMetallicRoughness?.metallicRoughnessTexture,
    anisotropy: material.extensions?.KHR_materials_anisotropy?.anisotropyTexture,
    offset: pyramid?.offsetTexture,
    factor: pyramid?.roughnessTexture,
  };
}
