import type { MeshPhysicalMaterial, MeshStandardMaterial, Material, Texture } from 'three';
import type { GLTFLoaderPlugin, GLTFParser } from 'three/addons/loaders/GLTFLoader.js';

/** Name of the glTF extension. */
export const EXTENSION: 'ROUGHCAST_materials_roughness_pyramid';

/** The local frame that offsets and roughness are given in. */
export type Frame = 'natural' | 'unit' | 'mainDirection';

/** What the roughness map holds: D = [[d1, d2], [0, d3]] of K = D D^T, or the square root of K's larger eigenvalue. */
export type RoughnessModel = 'covarianceFactor' | 'standardDeviation';

/** glTF's textureInfo. */
export interface TextureInfo {
  index: number;
  texCoord?: number;
  extensions?: Record<string, unknown>;
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
  /** Unit vector in the space of the mesh; null in the other frames. */
  mainDirection: number[] | null;
}

/** The extension object of a material, checked. */
export interface PyramidExtension extends Shared {
  offset: Range & { texture: TextureInfo };
  roughness: (Range & { texture: TextureInfo; model: RoughnessModel }) | null;
  /** The lobe that K is added to, where the core material has it folded in already. */
  baseLobe: BaseLobe | null;
}

/** A material's own lobe; what is absent has glTF's default. */
export interface BaseLobe {
  roughnessFactor?: number;
  metallicRoughnessTexture?: TextureInfo;
  /** KHR_materials_anisotropy. */
  anisotropy?: { anisotropyStrength?: number; anisotropyRotation?: number; anisotropyTexture?: TextureInfo };
}

/** The same with textures in linear colour space. */
export interface Pyramid extends Shared {
  /** (f_u, f_v) in red and green. */
  offset: Range & { map: Texture };
  roughness: (Range & { map: Texture; model: RoughnessModel }) | null;
}

/** @throws TypeError that names the property, when the object does not have the shape of the schema. */
export function readExtension(definition: unknown): PyramidExtension;

/**
 * Makes a material shade with a pyramid, and returns it. Its normal map and bump map are replaced; its own roughness and
 * anisotropy stay and are part of the lobe. `normalScale` scales the bumps. Clones are patched, too.
 *
 * @throws TypeError for materials of other kinds.
 */
export function applyPyramid<M extends MeshStandardMaterial | MeshPhysicalMaterial>(material: M, pyramid: Pyramid): M;

/**
 * Makes an anisotropic material, a portable bake for one, reflect the environment along its ellipse with 16 look-ups in the
 * place of three.js' one, and lights about axes that stand on its normal; returns it. Clones are patched, too.
 *
 * @throws TypeError for materials of other kinds.
 */
export function applyReflections<M extends MeshPhysicalMaterial>(material: M): M;

export interface RoughcastPluginOptions {
  /** Whether materials with KHR_materials_anisotropy, too, get {@link applyReflections}. Off by default. */
  reflections?: boolean;
}

/** `loader.register((parser) => new RoughcastPlugin(parser))` */
export class RoughcastPlugin implements GLTFLoaderPlugin {
  constructor(parser: GLTFParser, options?: RoughcastPluginOptions);
  readonly name: typeof EXTENSION;
  /** Null for materials without the extension. What cannot be used is told on the console and shown without it. */
  loadMaterial(index: number): Promise<Material> | null;
}
