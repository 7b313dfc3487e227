import { Extension, ExtensionProperty } from '@gltf-transform/core';
import type { Document, ReaderContext, Texture, TextureInfo, Transform, WriterContext } from '@gltf-transform/core';
import type { Backend, Report, Settings } from './bake.js';

export * from './bake.js';

/** Options of the transform. Its textures are KTX2 only, since glTF-Transform knows one image for each texture. */
export interface TransformOptions extends Omit<Settings, 'gltf' | 'glb' | 'engine'> {
  /** As of `bake`, without bevy and godot: these need a .gltf of `bake` with its textures beside it. */
  engine?: Exclude<Settings['engine'], 'bevy' | 'godot'>;
  backend?: Backend;
  /** Number of threads, as of `bake`. */
  threads?: number;
  /** Takes the share of the work that is done, as of `bake`. */
  onProgress?: (share: number) => void;
  /** Takes the report. Notes that ask for action are warnings in the document's log, too. */
  onReport?: (report: Report) => void;
}

/**
 * Returns a transform that bakes the materials of a document and replaces their textures by KTX2:
 * `await document.transform(roughcast({ profile: 'portable' }))`. A new texture has the name of the texture that it is
 * made from, and a URI after this name.
 *
 * @throws Error if `engine` is bevy or godot.
 */
export function roughcast(options?: TransformOptions): Transform;

/** Members of the extension object with plain values; the schema of the extension describes them. */
export interface PyramidValues {
  offsetChannels: 2 | 3;
  offsetScale: [number, number];
  roughnessModel: 'covarianceFactor' | 'standardDeviation' | null;
  roughnessMin: number[] | null;
  roughnessMax: number[] | null;
  correctionFactor: number;
  frame: 'natural' | 'unit' | 'mainDirection';
  mainDirection: [number, number, number] | null;
}

/** The numbers of the base lobe. Absent ones have the defaults of glTF. */
export interface BaseLobe {
  roughnessFactor?: number;
  anisotropy?: { anisotropyStrength?: number; anisotropyRotation?: number };
}

/** The extension object of a material. */
export class Pyramid extends ExtensionProperty {
  static EXTENSION_NAME: 'ROUGHCAST_materials_roughness_pyramid';
  extensionName: 'ROUGHCAST_materials_roughness_pyramid';
  propertyType: 'Pyramid';
  parentTypes: string[];
  protected init(): void;
  getValue<Name extends keyof PyramidValues>(name: Name): PyramidValues[Name];
  setValue<Name extends keyof PyramidValues>(name: Name, value: PyramidValues[Name]): this;
  getBaseLobe(): BaseLobe | null;
  setBaseLobe(lobe: BaseLobe | null): this;
  getOffsetTexture(): Texture | null;
  getOffsetTextureInfo(): TextureInfo | null;
  setOffsetTexture(texture: Texture | null): this;
  getRoughnessTexture(): Texture | null;
  getRoughnessTextureInfo(): TextureInfo | null;
  setRoughnessTexture(texture: Texture | null): this;
  getBaseMetallicRoughnessTexture(): Texture | null;
  getBaseMetallicRoughnessTextureInfo(): TextureInfo | null;
  setBaseMetallicRoughnessTexture(texture: Texture | null): this;
  getBaseAnisotropyTexture(): Texture | null;
  getBaseAnisotropyTextureInfo(): TextureInfo | null;
  setBaseAnisotropyTexture(texture: Texture | null): this;
}

/**
 * Keeps ROUGHCAST_materials_roughness_pyramid when documents are read and written:
 * `new NodeIO().registerExtensions([...ALL_EXTENSIONS, RoughnessPyramid])`.
 */
export class RoughnessPyramid extends Extension {
  static readonly EXTENSION_NAME: 'ROUGHCAST_materials_roughness_pyramid';
  readonly extensionName: 'ROUGHCAST_materials_roughness_pyramid';
  createPyramid(): Pyramid;
  read(context: ReaderContext): this;
  write(context: WriterContext): this;
}
