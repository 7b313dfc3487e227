// Uses of the package that must compile, and uses that must not.
import { MeshBasicMaterial, MeshPhysicalMaterial, MeshStandardMaterial, Texture } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import {
  applyPyramid,
  applyReflections,
  EXTENSION,
  type Frame,
  type Pyramid,
  readExtension,
  RoughcastPlugin,
} from 'three-roughcast';

const loader = new GLTFLoader();
loader.register((parser) => new RoughcastPlugin(parser));
loader.register((parser) => new RoughcastPlugin(parser, { reflections: true }));
// @ts-expect-error: there is no such option
loader.register((parser) => new RoughcastPlugin(parser, { reflection: true }));

const pyramid: Pyramid = {
  offset: { map: new Texture(), channels: 3, scale: [1, 1] },
  roughness: { map: new Texture(), model: 'standardDeviation', min: [0], max: [0.5] },
  correctionFactor: 0.8,
  frame: 'unit',
  mainDirection: null,
};
const standard: MeshStandardMaterial = applyPyramid(new MeshStandardMaterial(), pyramid);
const physical: MeshPhysicalMaterial = applyReflections(
  applyPyramid(new MeshPhysicalMaterial(), { ...pyramid, roughness: null }),
);
// @ts-expect-error: unlit materials have no lobe
applyPyramid(new MeshBasicMaterial(), pyramid);
// @ts-expect-error: there is no such frame
const frame: Frame = 'world';

const { offset, roughness, baseLobe } = readExtension({});
const name: 'ROUGHCAST_materials_roughness_pyramid' = EXTENSION;
export const used = [
  standard,
  physical,
  frame,
  offset.texture.index,
  roughness?.model,
  baseLobe?.anisotropy?.anisotropyStrength,
  name,
];
