// The extension object of a material, read and checked.

/** Name of the glTF extension. */
export const EXTENSION = 'ROUGHCAST_materials_roughness_pyramid';

/** The format version that the plugin reads. */
const FORMAT_VERSION = 1;

/** Channels of the roughness texture, by model. */
const CHANNELS = { covarianceFactor: 3, standardDeviation: 1 };
const FRAMES = ['natural', 'unit', 'mainDirection'];

/**
 * Checks an extension object and fills in what is absent. See index.d.ts.
 *
 * @throws {TypeError} that names the property, when it does not have the shape of the schema.
 */
export function readExtension(definition) {
  if (typeof definition !== 'object' || definition === null || Array.isArray(definition)) {
    throw new TypeError(`${EXTENSION}: expected an object, found ${JSON.stringify(definition)}`);
  }
  if (definition.formatVersion !== FORMAT_VERSION) {
    const expected = `${FORMAT_VERSION} (other versions need another version of the plugin)`;
    throw wrong('formatVersion', expected, definition.formatVersion);
  }
  const frame = oneOf(definition, 'frame', FRAMES);
  const correctionFactor = definition.correctionFactor;
  if (!Number.isFinite(correctionFactor) || correctionFactor < 0) {
    throw wrong('correctionFactor', 'a number of at least 0', correctionFactor);
  }
  return {
    offset: ranged(definition, 'offset', 2),
    roughness: readRoughness(definition),
    correctionFactor,
    frame,
    mainDirection: frame === 'mainDirection' ? numbers(definition, 'mainDirection', 3) : null,
    baseLobe: readBaseLobe(definition.baseLobe),
  };
}

/** Returns the base lobe, or null where the core material itself has it. */
function readBaseLobe(baseLobe) {
  if (baseLobe === undefined) return null;
  if (typeof baseLobe !== 'object' || baseLobe === null || Array.isArray(baseLobe))
    throw wrong('baseLobe', 'an object', baseLobe);
  return baseLobe;
}

/** Returns a glTF material with the base lobe in place of the roughened one. */
export function withBaseLobe(material, { roughnessFactor, metallicRoughnessTexture, anisotropy }) {
  const base = { roughnessFactor, metallicRoughnessTexture };
  return {
    ...material,
    pbrMetallicRoughness: defined({ ...material.pbrMetallicRoughness, ...base }),
    extensions: defined({ ...material.extensions, KHR_materials_anisotropy: anisotropy }),
  };
}

function defined(members) {
  return Object.fromEntries(Object.entries(members).filter(([, value]) => value !== undefined));
}

function readRoughness(definition) {
  if (definition.roughnessModel === undefined && definition.roughnessTexture === undefined) return null;
  const model = oneOf(definition, 'roughnessModel', Object.keys(CHANNELS));
  return { model, ...ranged(definition, 'roughness', CHANNELS[model]) };
}

/** Returns a texture with the values that texels of 0 and 1 stand for. */
function ranged(definition, name, channels) {
  const texture = definition[`${name}Texture`];
  if (!Number.isInteger(texture?.index) || texture.index < 0) {
    throw wrong(`${name}Texture`, 'a textureInfo', texture);
  }
  return {
    texture,
    min: numbers(definition, `${name}Min`, channels),
    max: numbers(definition, `${name}Max`, channels),
  };
}

function numbers(definition, name, count) {
  const value = definition[name];
  if (!Array.isArray(value) || value.length !== count || !value.every(Number.isFinite)) {
    throw wrong(name, `${count} number(s)`, value);
  }
  return [...value];
}

function oneOf(definition, name, names) {
  const value = definition[name];
  if (!names.includes(value)) throw wrong(name, names.join(' or '), value);
  return value;
}

function wrong(name, expected, found) {
  return new TypeError(`${EXTENSION}: ${name}: expected ${expected}, found ${JSON.stringify(found)}`);
}
