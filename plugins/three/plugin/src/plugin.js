import { EXTENSION, readExtension, texturesOf, withBaseLobe } from './extension.js';
import { applyPyramid, applyReflections } from './material.js';

/** Plugin of GLTFLoader. See index.d.ts. */
export class RoughcastPlugin {
  constructor(parser, { reflections = false } = {}) {
    this.parser = parser;
    this.reflections = reflections;
    this.name = EXTENSION;
  }

  /** Returns null to leave the material to the loader. */
  loadMaterial(index) {
    const { [EXTENSION]: definition, KHR_materials_anisotropy: anisotropy } =
      this.parser.json.materials[index].extensions ?? {};
    if (definition !== undefined) return this.#load(index, definition);
    return this.reflections && anisotropy ? this.parser.loadMaterial(index).then(reflecting) : null;
  }

  async #load(index, definition) {
    const { materials } = this.parser.json;
    let extension;
    try {
      extension = readExtension(definition);
    } catch (error) {
      console.warn(`materials[${index}]: ${error.message}; shown without it`);
      return this.parser.loadMaterial(index);
    }
    const { roughness, baseLobe, ...rest } = extension;
    const [offsetMap, roughnessMap, hasBaseLobe] = await Promise.all([
      this.#texture(extension.offset.texture),
      roughness && this.#texture(roughness.texture),
      this.#canLoad(texturesOf(baseLobe)),
    ]);
    const isComplete = offsetMap && (!roughness || roughnessMap) && hasBaseLobe;
    // Other plugins of the loader read the material from the same list.
    if (isComplete && baseLobe) materials[index] = withBaseLobe(materials[index], baseLobe);
    const material = await this.parser.loadMaterial(index);
    if (!material.isMeshStandardMaterial || !isComplete) {
      const reason = material.isMeshStandardMaterial ? 'a texture cannot be loaded' : `${material.type} is not lit`;
      console.warn(`materials[${index}]: ${EXTENSION}: ${reason}; shown without it`);
      return material;
    }
    return applyPyramid(material, {
      ...rest,
      offset: { ...extension.offset, map: offsetMap },
      roughness: roughness && { ...roughness, map: roughnessMap },
    });
  }

  /** Loads the texture of a textureInfo, with its texture coordinates and transform, or null if it cannot be loaded. */
  async #texture(info) {
    // assignTexture writes a transform's texCoord into `info`, and clones textures whose mapping is not the default.
    return attempt(() => this.parser.assignTexture({}, 'map', info));
  }

  /** Returns whether all textures can be loaded. The parser keeps them for the material. */
  async #canLoad(infos) {
    const textures = infos.map(({ index }) => attempt(() => this.parser.getDependency('texture', index)));
    return (await Promise.all(textures)).every(Boolean);
  }
}

/** Returns what a step loads, or null if it fails. The loader throws, for example, for an index without a texture. */
async function attempt(step) {
  try {
    return await step();
  } catch {
    return null;
  }
}

function reflecting(material) {
  return material.isMeshStandardMaterial ? applyReflections(material) : material;
}
