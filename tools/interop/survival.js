// What a command keeps of a baked asset, as the cells of a table.
import { PYRAMID, read, slots } from './asset.js';

/** The slots of the core material whose textures the bake makes. */
const CORE = ['normal', 'roughness', 'anisotropy'];

/** Columns of the table, besides validity. */
export const COLUMNS = ['baked textures', '`KHR_texture_basisu`', '`KHR_materials_anisotropy`', 'tangents', 'pyramid'];

/**
 * Compares the only material of a file with that of the file before a command.
 *
 * @returns {string[]} one cell for each of COLUMNS.
 */
export function compare(before, after) {
  const [old, found] = [before, after].map(describe);
  return [
    textures(old, found, CORE),
    CORE.every((slot) => found.images[slot]?.source === 'KHR_texture_basisu') ? 'kept' : 'lost',
    found.anisotropy === old.anisotropy ? 'kept' : found.anisotropy === undefined ? 'lost' : 'changed',
    found.hasTangents ? 'kept' : 'lost',
    pyramid(old, found),
  ];
}

function describe(file) {
  const { json, image } = read(file);
  const primitive = json.meshes[0].primitives[0];
  const material = json.materials[primitive.material];
  const shown = Object.entries(slots(material)).filter(([, info]) => info !== undefined);
  const { anisotropyTexture, ...factors } = material.extensions?.KHR_materials_anisotropy ?? {};
  return {
    images: Object.fromEntries(shown.map(([slot, info]) => [slot, image(info)])),
    anisotropy: anisotropyTexture && JSON.stringify(factors),
    hasTangents: primitive.attributes.TANGENT !== undefined,
    pyramid: material.extensions?.[PYRAMID],
  };
}

/** Says what became of the images in `names`. Equal bytes have equal mips. */
function textures(old, found, names) {
  const lost = names.filter((name) => found.images[name] === undefined);
  if (lost.length > 0) return `no ${lost.join(', ')}`;
  const changed = names.filter((name) => found.images[name].digest !== old.images[name].digest);
  if (changed.length === 0) return 'kept';
  // A changed KTX2 has levels of the command, not those of the bake. The other formats have no mips.
  const formats = [...new Set(changed.map((name) => found.images[name].format))].join(', ');
  const what = `${formats}, ${formats === 'KTX2' ? 'other levels' : 'no mips'}`;
  return changed.length === names.length ? what : `${changed.join(', ')}: ${what}`;
}

function pyramid(old, found) {
  if (found.pyramid === undefined) return 'lost';
  const names = ['offset', 'factor'];
  return names.every((name) => found.images[name]?.digest === old.images[name].digest) ? 'kept' : 'broken';
}
