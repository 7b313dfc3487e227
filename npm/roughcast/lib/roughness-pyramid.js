// The extension ROUGHCAST_materials_roughness_pyramid for glTF-Transform.
import { Extension, ExtensionProperty, PropertyType, TextureChannel, TextureInfo } from '@gltf-transform/core';

const NAME = 'ROUGHCAST_materials_roughness_pyramid';
/** The version of the extension that is read and written. */
const VERSION = 2;
const { R, G, B } = TextureChannel;

/** Members with plain values, each with the attribute that holds it. */
const VALUES = [
  'offsetChannels',
  'offsetScale',
  'roughnessModel',
  'roughnessMin',
  'roughnessMax',
  'correctionFactor',
  'frame',
  'mainDirection',
];

/** Offsets and roughness of the bumps that mip levels have lost. */
export class Pyramid extends ExtensionProperty {
  static EXTENSION_NAME = NAME;

  init() {
    this.extensionName = NAME;
    this.propertyType = 'Pyramid';
    this.parentTypes = [PropertyType.MATERIAL];
  }

  getDefaults() {
    const texture = (name) => ({ [name]: null, [`${name}Info`]: new TextureInfo(this.graph, `${name}Info`) });
    return {
      ...super.getDefaults(),
      ...texture('offsetTexture'),
      offsetChannels: 3,
      offsetScale: [1, 1],
      ...texture('roughnessTexture'),
      roughnessModel: null,
      roughnessMin: null,
      roughnessMax: null,
      correctionFactor: 1,
      frame: 'unit',
      mainDirection: null,
      baseLobe: null,
      ...texture('baseMetallicRoughnessTexture'),
      ...texture('baseAnisotropyTexture'),
    };
  }

  /** Returns the value of a member; null if the extension object does not have it. */
  getValue(name) {
    return this.get(checkedName(name));
  }

  setValue(name, value) {
    return this.set(checkedName(name), value);
  }

  /** Returns the numbers of the base lobe, as the extension object has them, without textures; null without it. */
  getBaseLobe() {
    return this.get('baseLobe');
  }

  setBaseLobe(lobe) {
    return this.set('baseLobe', lobe);
  }

  getOffsetTexture() {
    return this.getRef('offsetTexture');
  }

  getOffsetTextureInfo() {
    return this.getOffsetTexture() ? this.getRef('offsetTextureInfo') : null;
  }

  setOffsetTexture(texture) {
    return this.setRef('offsetTexture', texture, { channels: R | G | B });
  }

  getRoughnessTexture() {
    return this.getRef('roughnessTexture');
  }

  getRoughnessTextureInfo() {
    return this.getRoughnessTexture() ? this.getRef('roughnessTextureInfo') : null;
  }

  setRoughnessTexture(texture) {
    return this.setRef('roughnessTexture', texture, { channels: R | G | B });
  }

  getBaseMetallicRoughnessTexture() {
    return this.getRef('baseMetallicRoughnessTexture');
  }

  getBaseMetallicRoughnessTextureInfo() {
    return this.getBaseMetallicRoughnessTexture() ? this.getRef('baseMetallicRoughnessTextureInfo') : null;
  }

  setBaseMetallicRoughnessTexture(texture) {
    return this.setRef('baseMetallicRoughnessTexture', texture, { channels: G | B });
  }

  getBaseAnisotropyTexture() {
    return this.getRef('baseAnisotropyTexture');
  }

  getBaseAnisotropyTextureInfo() {
    return this.getBaseAnisotropyTexture() ? this.getRef('baseAnisotropyTextureInfo') : null;
  }

  setBaseAnisotropyTexture(texture) {
    return this.setRef('baseAnisotropyTexture', texture, { channels: R | G | B });
  }
}

function checkedName(name) {
  if (VALUES.includes(name)) return name;
  throw new TypeError(`expected one of ${VALUES.join(', ')}, found ${name}`);
}

/** Reads and writes the extension: `io.registerExtensions([RoughnessPyramid])`. */
export class RoughnessPyramid extends Extension {
  static EXTENSION_NAME = NAME;
  extensionName = NAME;
  // Before KHR_texture_transform, which reads what textureInfos were found by then.
  prereadTypes = [PropertyType.MESH];
  prewriteTypes = [PropertyType.MESH];

  /** Returns a new property for a material. */
  createPyramid() {
    return new Pyramid(this.document.getGraph());
  }

  read() {
    return this;
  }

  write() {
    return this;
  }

  preread(context) {
    const { materials = [] } = context.jsonDoc.json;
    materials.forEach((material, index) => {
      const definition = material.extensions?.[NAME];
      if (!definition) return;
      if (definition.formatVersion === VERSION) {
        context.materials[index].setExtension(NAME, this.#read(context, definition));
      } else {
        const found = `found ${definition.formatVersion}; the extension of material ${index} is left out`;
        this.document.getLogger().warn(`${NAME}: expected formatVersion ${VERSION}, ${found}. Update roughcast.`);
      }
    });
    return this;
  }

  #read(context, definition) {
    const pyramid = this.createPyramid();
    if (definition.extras) pyramid.setExtras(definition.extras);
    for (const name of VALUES) {
      if (definition[name] !== undefined) pyramid.setValue(name, definition[name]);
    }
    const textures = context.jsonDoc.json.textures ?? [];
    const readTexture = (info, name) => {
      if (info === undefined) return;
      pyramid[`set${name}`](context.textures[textures[info.index].source]);
      context.setTextureInfo(pyramid[`get${name}Info`](), info);
    };
    readTexture(definition.offsetTexture, 'OffsetTexture');
    readTexture(definition.roughnessTexture, 'RoughnessTexture');
    if (definition.baseLobe) {
      const { metallicRoughnessTexture, anisotropy, ...lobe } = definition.baseLobe;
      readTexture(metallicRoughnessTexture, 'BaseMetallicRoughnessTexture');
      if (anisotropy) {
        const { anisotropyTexture, ...numbers } = anisotropy;
        readTexture(anisotropyTexture, 'BaseAnisotropyTexture');
        lobe.anisotropy = numbers;
      }
      pyramid.setBaseLobe(lobe);
    }
    return pyramid;
  }

  prewrite(context) {
    for (const material of this.document.getRoot().listMaterials()) {
      const pyramid = material.getExtension(NAME);
      if (!pyramid) continue;
      const definition = context.jsonDoc.json.materials[context.materialIndexMap.get(material)];
      definition.extensions = { ...definition.extensions, [NAME]: this.#write(context, pyramid) };
    }
    return this;
  }

  #write(context, pyramid) {
    const textureOf = (name, member) => {
      const texture = pyramid[`get${name}`]();
      return texture && { [member]: context.createTextureInfoDef(texture, pyramid[`get${name}Info`]()) };
    };
    const definition = {
      formatVersion: VERSION,
      ...context.createPropertyDef(pyramid),
      ...textureOf('OffsetTexture', 'offsetTexture'),
      ...textureOf('RoughnessTexture', 'roughnessTexture'),
    };
    for (const name of VALUES) {
      if (pyramid.getValue(name) !== null) definition[name] = pyramid.getValue(name);
    }
    const lobe = pyramid.getBaseLobe();
    if (lobe) {
      const { anisotropy } = lobe;
      definition.baseLobe = {
        ...lobe,
        ...textureOf('BaseMetallicRoughnessTexture', 'metallicRoughnessTexture'),
        ...(anisotropy && {
          anisotropy: { ...anisotropy, ...textureOf('BaseAnisotropyTexture', 'anisotropyTexture') },
        }),
      };
    }
    return definition;
  }
}
