// Bytes to bytes. Needs no other package.

/** Settings of a bake: those of roughcast.toml in camelCase. `roughcast bake --help` explains each. */
export interface Settings {
  /** Which data to write. Default: portable. */
  profile?: 'portable' | 'pyramid' | 'both';
  /** What is modelled of the lost bumps. Default: auto, the cheapest model within `maxError`. */
  model?: 'auto' | 'none' | 'isotropic' | 'anisotropic';
  /** The model with the most parameters that `auto` may choose. Default: anisotropic. */
  maxModel?: 'isotropic' | 'anisotropic';
  /** Largest mean lobe error at any level, in [0, 1], that `auto` accepts. Default: 0.1. */
  maxError?: number;
  /** How well lobes are fitted and how long block encoders search. Default: fast. */
  quality?: 'fast' | 'best';
  /** Signal-to-noise ratio in dB, above 0 and up to 6, that each level may lose for fewer bytes. Default: none. */
  rdo?: number;
  /** Most texels along a side of a written texture, at least 4. Default: none, the size of the images. */
  maxSize?: number;
  /** Assumed distribution of the slopes under a texel. Default: auto, which measures it. */
  distribution?: 'auto' | 'normal' | 'uniform';
  /** The lobe that the engine shades with. Default: ggx. */
  lobe?: 'ggx' | 'beckmann';
  /** Payload: UASTC, BC (native tool only) or half floats. Default: basis. */
  target?: 'basis' | 'bc' | 'float';
  /** Largest number of texels of an input image. Default: 2^28. */
  maxTexels?: number;
  /** Whether version, settings and source digests are written into each KTX2. Default: true. */
  provenance?: boolean;
  /**
   * Preset of `target`, `gltf`, `glb`, `model`, `maxModel`, `ownAnisotropy` and `scaleNormals` for an engine;
   * explicit settings win over it.
   */
  engine?: 'three' | 'babylon' | 'playcanvas' | 'filament' | 'bevy' | 'godot';
  /** Which textures are written: normals, roughness and anisotropy, or also base colour and others. Default: bumps. */
  textures?: 'bumps' | 'all';
  /** The light that base colours are baked for; `suns` needs `textures: 'all'`. Default: environment. */
  diffuseLight?: 'environment' | 'suns';
  /** What becomes of the anisotropy that a material has of its own. Default: bake, or what `engine` needs. */
  ownAnisotropy?: 'bake' | 'keep' | 'ignore';
  /**
   * Whether low bumps are stretched in their texture, and `normalTexture.scale` shrinks them. Default: true where
   * `gltf` is strict, or what `engine` needs.
   */
  scaleNormals?: boolean;
  /** How the document refers to textures. Default: strict, or what `engine` needs. */
  gltf?: 'strict' | 'fallback' | 'dual';
  /** Whether a .glb with everything inside is written. Default: the container of the input. */
  glb?: boolean;
  /** Frame of the offsets of the pyramid profile. Default: unit. */
  frame?: 'natural' | 'unit' | 'main-direction';
  /** Direction m of `frame: 'main-direction'`, in the space of the mesh. Default: [0, 1, 0]. */
  mainDirection?: [number, number, number];
  /** Height of height maps between 0 and 1, in widths of a repeat, instead of the value of the asset. */
  heightScale?: number;
  /** Smallest distance of the camera in units of the scene, with `screenHeight`: for `trim` and the report. */
  nearest?: number;
  /** Rows of pixels of the screen. */
  screenHeight?: number;
  /** Vertical field of view in degrees. */
  fov?: number;
  /** Width of the screen over its height. */
  aspect?: number;
  /** Whether levels that the camera never samples are left out. Default: false. */
  trim?: boolean;
}

/** Settings of a standalone map. */
export type MapSettings = Pick<
  Settings,
  | 'profile'
  | 'model'
  | 'maxError'
  | 'quality'
  | 'rdo'
  | 'distribution'
  | 'lobe'
  | 'target'
  | 'maxSize'
  | 'maxTexels'
  | 'provenance'
>;

/** Default: $ROUGHCAST_BACKEND, else the native tool where its package is installed, else WebAssembly. */
export type Backend = 'native' | 'wasm';

/** What a bake left unchanged or cannot make exact, and why. */
export interface Note {
  kind: string;
  /** Whether another source, document or setting can improve the result. */
  asksForAction: boolean;
  text: string;
}

/** A candidate for the roughness data of a layer. */
export interface Candidate {
  model: 'none' | 'isotropic' | 'anisotropic';
  /** The level that becomes level 0 of the textures. */
  first: number;
  /** Bytes of the textures on the GPU. */
  bytes: number;
  /** Mean lobe error of each decoded level, in [0, 1], from `Choice.finest` on. */
  errors: number[];
}

/** How the model of a layer was chosen. */
export interface Choice {
  /** The finest level that can be sampled. */
  finest: number;
  candidates: Candidate[];
  /** Index of the chosen candidate. */
  chosen: number;
  /** Levels at which the chosen candidate exceeds the error bound. */
  misses: { level: number; error: number; oracle: number; reason: unknown }[];
}

/** What became of a layer of a material. */
export interface LayerReport {
  /** Index of the material. */
  index: number;
  /** Name of the material. */
  material: string;
  layer: 'base' | 'clearcoat';
  /** Absent if nothing was baked. */
  model?: 'none' | 'isotropic' | 'anisotropic';
  choice?: Choice;
  notes: Note[];
}

/** A texture that was made. */
export interface TextureReport {
  path: string;
  content: string;
  width: number;
  height: number;
  levels: number;
  /** Bytes of the KTX2. */
  bytes: number;
}

/** What was done; schemas/report.schema.json of Roughcast describes all members. */
export interface Report {
  /** The version of Roughcast. */
  version: string;
  /** The settings that change the bytes of textures, with their defaults. */
  settings: Record<string, unknown>;
  layers: LayerReport[];
  textures: TextureReport[];
}

/** A file, whose path is relative to the document. */
export interface OutputFile {
  path: string;
  bytes: Uint8Array;
}

export interface BakeOptions {
  /** File name of the document without its extension; outputs are named after it. Default: model. */
  name?: string;
  /** The files that the document names, by their paths relative to it. */
  files?: Record<string, Uint8Array> | ((path: string) => Uint8Array | null | Promise<Uint8Array | null>);
  settings?: Settings;
  /**
   * Number of threads, from 0 to 64; 0, the default, is one for each processor. WebAssembly in browsers has one thread
   * unless the page is cross-origin isolated. The bytes do not depend on it.
   */
  threads?: number;
  /**
   * Takes the share of the work that is done, in [0, 1]. WebAssembly calls it after each bump map, the native tool once
   * with 1 when the bake is done. With one bump map, both call it once.
   */
  onProgress?: (share: number) => void;
  backend?: Backend;
}

export interface Baked {
  document: OutputFile;
  /** New files beside the document; none beside a .glb. */
  files: OutputFile[];
  /** Files that the new document names and that did not change. */
  copies: string[];
  report: Report;
}

/**
 * Bakes the materials of a glTF document, given as the bytes of a .gltf or .glb file.
 *
 * @throws Error whose message names the material and the texture, what was expected, and what to do; TypeError if
 * `document` is no Uint8Array or a setting is unknown.
 */
export function bake(document: Uint8Array, options?: BakeOptions): Promise<Baked>;

export interface BakeMapOptions {
  /** File name of the image, by which TGA is recognised. Default: map.png. */
  name?: string;
  /** File name of the bump map's KTX2. Default: that of the image with the extension .ktx2. */
  output?: string;
  /** The image holds heights, not normals. */
  height?: boolean;
  /** Distance between heights 0 and 1, in widths of the map. Default: 0.05. */
  heightScale?: number;
  /** How a height map continues beyond its border, across and down. Default: repeat. */
  wrap?: ['repeat' | 'mirror' | 'clamp', 'repeat' | 'mirror' | 'clamp'];
  /** The channels that hold the normal. Default: auto. */
  channels?: 'auto' | 'xyz' | 'xy';
  /** Green points down the image (DirectX convention). */
  greenDown?: boolean;
  /** The layer of an EXR file, or the channel as layer.channel. */
  layer?: string;
  /** The roughness map of the base lobe. */
  roughness?: { image: Uint8Array; name?: string };
  /** The roughness of the base lobe in [0, 1]; multiplies `roughness`. */
  roughnessFactor?: number;
  settings?: MapSettings;
  /** Number of threads, as of `bake`. */
  threads?: number;
  backend?: Backend;
}

export interface BakedMap {
  /** KTX2 files. The first one is the bump map: normals, or offsets in the pyramid profile. */
  files: OutputFile[];
  report: { model: string; choice?: Choice; notes: Note[]; textures: TextureReport[] };
}

/**
 * Bakes a standalone normal or height map (PNG, JPEG, EXR, TIFF, TGA, HDR, WebP or KTX2) into KTX2 files.
 *
 * @throws Error whose message names the image, what was expected, and what to do; TypeError if `image` is no Uint8Array
 * or a setting is unknown.
 */
export function bakeMap(image: Uint8Array, options?: BakeMapOptions): Promise<BakedMap>;
