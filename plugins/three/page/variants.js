// The variants of an asset: their names, and which of them a document is.

/** The vendor extension of the pyramid profile. */
const EXTENSION = 'ROUGHCAST_materials_roughness_pyramid';

/** Variants and their titles, in the order in which they are shown. */
export const TITLES = {
  original: 'Plain mips',
  portable: 'Portable bake',
  pyramid: 'Pyramid bake',
  supersampled: 'Supersampled',
};
export const VARIANTS = Object.keys(TITLES);

/**
 * Reads the JSON of a .gltf or .glb file.
 *
 * @param {Uint8Array} bytes
 * @throws Error where the bytes hold no JSON.
 */
export function readDocument(bytes) {
  const text = (from, to) => new TextDecoder().decode(bytes.subarray(from, to));
  if (text(0, 4) !== 'glTF') return JSON.parse(text(0));
  if (bytes.length < 20) throw new Error(`expected 20 bytes of GLB, found ${bytes.length}; the file is cut short`);
  const length = new DataView(bytes.buffer, bytes.byteOffset).getUint32(12, true);
  return JSON.parse(text(20, 20 + length));
}

/** Returns which variant a document is. Bakes carry their provenance in `asset.extras.roughcast`. */
export function variantOf(document) {
  if (document.extensionsUsed?.includes(EXTENSION)) return 'pyramid';
  return document.asset?.extras?.roughcast ? 'portable' : 'original';
}

/** Follows the title of a bake that three.js itself draws wrongly. */
export const MISDRAWN = 'three.js draws these anisotropic lobes wrongly: bake with --engine three.';

/** Returns whether three.js itself draws anisotropic lobes that Roughcast baked. Bakes store them in KTX2 files. */
export function isMisdrawn(document) {
  if (variantOf(document) !== 'portable') return false;
  const { materials = [], textures = [] } = document;
  return materials.some(({ extensions }) => {
    const { index } = extensions?.KHR_materials_anisotropy?.anisotropyTexture ?? {};
    return textures[index]?.extensions?.KHR_texture_basisu !== undefined;
  });
}
