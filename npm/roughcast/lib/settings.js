// Settings: camelCase in JavaScript; the names of roughcast.toml, which are those of the flags, elsewhere.

/** Names of the settings of standalone maps, which documents have, too. */
export const MAP_SETTINGS = [
  'profile',
  'model',
  'maxError',
  'quality',
  'rdo',
  'distribution',
  'lobe',
  'target',
  'maxSize',
  'maxTexels',
  'provenance',
];

/** Names of the settings that only documents have. */
export const DOCUMENT_SETTINGS = [
  'maxModel',
  'ownAnisotropy',
  'engine',
  'textures',
  'diffuseLight',
  'gltf',
  'glb',
  'scaleNormals',
  'frame',
  'mainDirection',
  'heightScale',
  'nearest',
  'screenHeight',
  'fov',
  'aspect',
  'trim',
];

/**
 * Returns settings under the names of roughcast.toml, without those that are undefined.
 *
 * @param {object} settings such as { maxError: 0.05 }
 * @param {string[]} [known] names of the settings that can be used
 * @returns {Record<string, unknown>} such as { 'max-error': 0.05 }
 */
export function tomlSettings(settings = {}, known = [...MAP_SETTINGS, ...DOCUMENT_SETTINGS]) {
  // The command line gives the names of roughcast.toml.
  const names = new Set(known.map(kebab));
  const unknown = Object.keys(settings).find((name) => !names.has(kebab(name)));
  if (unknown !== undefined) {
    throw new TypeError(`settings: expected names among ${known.join(', ')}; found ${unknown}; correct or remove it`);
  }
  return defined(settings);
}

/**
 * Returns settings, or other options, as flags of the command line.
 *
 * @param {object} settings
 * @returns {string[]} such as ['--max-error=0.05']
 */
export function flags(settings) {
  return Object.entries(defined(settings)).flatMap(([name, value]) => {
    if (name === 'provenance') return value ? [] : ['--no-provenance'];
    if (name === 'trim') return value ? ['--trim'] : [];
    return [`--${name}=${Array.isArray(value) ? value.join(',') : value}`];
  });
}

/** Returns the members that have a value, under the names of roughcast.toml. */
function defined(settings) {
  const entries = Object.entries(settings).filter(([, value]) => value !== undefined && value !== null);
  return Object.fromEntries(entries.map(([name, value]) => [kebab(name), value]));
}

/** Returns a name as roughcast.toml and the flags have it, such as `max-error` for `maxError`. */
export function kebab(name) {
  return name.replace(/[A-Z]/g, (letter) => `-${letter.toLowerCase()}`);
}
