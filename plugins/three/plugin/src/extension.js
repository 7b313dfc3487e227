// The extension object of a material, read and checked.

/** Name of the glTF extension. */
export const EXTENSION = 'ROUGHCAST_materials_roughness_pyramid';

/** The format version that the plugin reads. */
const FORMAT_VERSION = 2;

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
    offset: readOffset(definition),
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

function readOffset(definition) {
  const channels = definition.offsetChannels;
  if (channels !== 2 && channels !== 3) throw wrong('offsetChannels', '2 or 3', channels);
  return {
    texture: textureInfo(definition, 'offsetTexture'),
    channels,
    scale: numbers(definition, 'offsetScale', 2),
  };
}

function readRoughness(definition) {
  if (definition.roughnessModel === undefined && definition.roughnessTexture === undefined) return null;
  const model = oneOf(definition, 'roughnessModel', Object.keys(CHANNELS));
  return {
    model,
    texture: textureInfo(definition, 'roughnessTexture'),
    min: numbers(definition, 'roughnessMin', CHANNELS[model]),
    max: numbers(definition, 'roughnessMax', CHANNELS[model]),
  };
}

function textureInfo(definition, name) {
  const texture = definition[name];
  if (!Number.isInteger(texture?.index) || texture.index < 0) throw wrong(name, 'a textureInfo', texture);
  return texture;
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
