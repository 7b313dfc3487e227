import type { MeshPhysicalMaterial, MeshStandardMaterial, Material, Texture } from 'three';
import type { GLTFLoaderPlugin, GLTFParser } from 'three/addons/loaders/GLTFLoader.js';

/** Name of the glTF extension. */
export const EXTENSION: 'ROUGHCAST_materials_roughness_pyramid';

/** The local frame that offsets and roughness are given in. */
export type Frame = 'natural' | 'unit' | 'mainDirection';

/** What the roughness map holds: D = [[d1, d2], [0, d3]] of K = D D^T, or lambda_1 of K = lambda_1^2 1. */
export type RoughnessModel = 'covarianceFactor' | 'standardDeviation';

/** glTF's textureInfo. */
export interface TextureInfo {
  index: number;
  texCoord?: number;
  extensions?: Record<string, unknown>;
}

/** How the offset map holds offsets: (f_u, f_v) = scale * (-x, -y) / z for the stored unit normal (x, y, z). */
export interface OffsetCode {
  /** 3 where z is stored, 2 where the shader rebuilds z from x and y. */
  channels: 2 | 3;
  /** Of f_u and f_v. */
  scale: number[];
}

/** What texels of 0 and 1 stand for, channel by channel. */
export interface Range {
  min: number[];
  max: number[];
}

interface Shared {
  /** c: squared alphas A become A + 2 c K. At least 0. */
  correctionFactor: number;
  frame: Frame;
  /** Direction in the space of the mesh, with any length; null in the other frames. */
  mainDirection: number[] | null;
}

/** The extension object of a material, checked. */
export interface PyramidExtension extends Shared {
  offset: OffsetCode & { texture: TextureInfo };
  roughness: (Range & { texture: TextureInfo; model: RoughnessModel }) | null;
  /** The base lobe, where the core material is roughened; K is added to the base lobe. */
  baseLobe: BaseLobe | null;
}

/** The lobe of a material without lost bumps. Absent properties have glTF's defaults. */
export interface BaseLobe {
  roughnessFactor?: number;
  metallicRoughnessTexture?: TextureInfo;
  /** KHR_materials_anisotropy. */
  anisotropy?: { anisotropyStrength?: number; anisotropyRotation?: number; anisotropyTexture?: TextureInfo };
}

/** The data of a pyramid, with its textures loaded in linear colour space. */
export interface Pyramid extends Shared {
  /** Unit normals of scaled offsets. */
  offset: OffsetCode & { map: Texture };
  roughness: (Range & { map: Texture; model: RoughnessModel }) | null;
}

/**
 * Checks an extension object and fills in absent properties.
 *
 * @throws TypeError that names the property, when the object does not have the shape of the schema.
 */
export function readExtension(definition: unknown): PyramidExtension;

/**
 * Makes a material shade with a pyramid, and returns the material. The normal map and the bump map are replaced.
 * Roughness and anisotropy of the material stay: they are the base lobe. `normalScale` scales the bumps. Clones are
 * patched, too.
 *
 * @throws TypeError for materials of other kinds.
 */
export function applyPyramid<M extends MeshStandardMaterial | MeshPhysicalMaterial>(material: M, pyramid: Pyramid): M;

/**
 * Makes an anisotropic material, such as a portable bake, reflect the environment with 16 look-ups along its ellipse in
 * place of three.js' single look-up. Lights use axes perpendicular to the normal. Returns the material. Clones are
 * patched, too.
 *
 * @throws TypeError for materials of other kinds.
 */
export function applyReflections<M extends MeshPhysicalMaterial>(material: M): M;

export interface RoughcastPluginOptions {
  /** Whether {@link applyReflections} is applied to materials with KHR_materials_anisotropy as well. Off by default. */
  reflections?: boolean;
}

/** A plugin of GLTFLoader: `loader.register((parser) => new RoughcastPlugin(parser))`. */
export class RoughcastPlugin implements GLTFLoaderPlugin {
  constructor(parser: GLTFParser, options?: RoughcastPluginOptions);
  readonly name: typeof EXTENSION;
  /**
   * Returns null for materials without the extension. A material whose extension cannot be used is shown without it,
   * and a warning on the console says why.
   */
  loadMaterial(index: number): Promise<Material> | null;
}
