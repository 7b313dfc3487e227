// The extension object of a material, read and checked.

/** Name of the glTF extension. */
export const EXTENSION = 'ROUGHCAST_materials_roughness_pyramid';

/** The format version that the plugin reads. */
const FORMAT_VERSION = 2;

/** Channels of the roughness texture, by model. */
const CHANNELS = { covarianceFactor: 3, standardDeviation: 1 };
/** Members that an extension object has together or not at all. */
const ROUGHNESS = ['roughnessModel', 'roughnessTexture', 'roughnessMin', 'roughnessMax'];
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
  const correctionFactor = number(definition, 'correctionFactor');
  if (correctionFactor < 0) throw wrong('correctionFactor', 'a number of at least 0', correctionFactor);
  return {
    offset: readOffset(definition),
    roughness: readRoughness(definition),
    correctionFactor,
    frame,
    mainDirection: readMainDirection(definition, frame),
    baseLobe: readBaseLobe(definition),
  };
}

/** Returns the main direction, or null in the other frames. Shaders use the direction only, so any length will do. */
function readMainDirection(definition, frame) {
  if (frame === 'mainDirection') return numbers(definition, 'mainDirection', 3);
  if (definition.mainDirection === undefined) return null;
  throw wrong('mainDirection', `nothing with the frame ${frame}`, definition.mainDirection);
}

/** Returns the base lobe, or null where the core material itself has it. */
function readBaseLobe(definition) {
  if (definition.baseLobe === undefined) return null;
  const baseLobe = object(definition, 'baseLobe');
  optional(number, baseLobe, 'roughnessFactor');
  optional(textureInfo, baseLobe, 'metallicRoughnessTexture');
  const anisotropy = optional(object, baseLobe, 'anisotropy') ?? {};
  optional(number, anisotropy, 'anisotropyStrength');
  optional(number, anisotropy, 'anisotropyRotation');
  optional(textureInfo, anisotropy, 'anisotropyTexture');
  return baseLobe;
}

/** Returns the textures of a base lobe, each as a textureInfo. */
export function texturesOf(baseLobe) {
  const { metallicRoughnessTexture, anisotropy } = baseLobe ?? {};
  return [metallicRoughnessTexture, anisotropy?.anisotropyTexture].filter((info) => info !== undefined);
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
  if (ROUGHNESS.every((name) => definition[name] === undefined)) return null;
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
  if (!isIndex(texture?.index)) throw wrong(name, 'a textureInfo', texture);
  if (texture.texCoord !== undefined && !isIndex(texture.texCoord)) throw wrong(name, 'a textureInfo', texture);
  return texture;
}

const isIndex = (value) => Number.isInteger(value) && value >= 0;

function numbers(definition, name, count) {
  const value = definition[name];
  if (!Array.isArray(value) || value.length !== count || !value.every(Number.isFinite)) {
    throw wrong(name, `${count} number(s)`, value);
  }
  return [...value];
}

function number(definition, name) {
  const value = definition[name];
  if (!Number.isFinite(value)) throw wrong(name, 'a number', value);
  return value;
}

function object(definition, name) {
  const value = definition[name];
  if (typeof value !== 'object' || value === null || Array.isArray(value)) throw wrong(name, 'an object', value);
  return value;
}

/** Reads a member that may be absent. */
function optional(read, definition, name) {
  return definition[name] === undefined ? undefined : read(definition, name);
}

function oneOf(definition, name, names) {
  const value = definition[name];
  if (!names.includes(value)) throw wrong(name, names.join(' or '), value);
  return value;
}

function wrong(name, expected, found) {
  return new TypeError(`${EXTENSION}: ${name}: expected ${expected}, found ${JSON.stringify(found)}`);
}
