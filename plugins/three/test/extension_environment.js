// A picture of a plane with ROUGHCAST_materials_roughness_pyramid under an environment, drawn as
// docs/extension/README.md describes it. It shares no code with the plugin.
import { points } from './extension_picture.js';
import * as reader from './extension_reader.js';
import { dot, sum } from './vectors.js';

/** The method of the page: the number of look-ups, the share of the smaller spread in blur, a factor on the rest. */
export const METHOD = { count: 16, blur: 1 / 4, spread: 1.3 };
/** Returns the mean of colours. */
const mean = (colours) => sum(...colours.map((colour) => [colour, 1 / colours.length]));

/** Returns whether the page has several look-ups for a material. */
function isAnisotropic({ extensions }) {
  const { [reader.EXTENSION]: extension, KHR_materials_anisotropy: core } = extensions;
  const { anisotropyStrength = 0 } = (extension.baseLobe ? extension.baseLobe.anisotropy : core) ?? {};
  return extension.roughnessModel === 'covarianceFactor' || anisotropyStrength > 0;
}

/** Returns the radiance of a point ("Environments"), from the mean reflection and the irradiance over pi: RGB. */
function radiance({ lit, eye }, { baseColorFactor, metallicFactor: metalness }, reflection, irradiance, engine) {
  const cosine = Math.max(dot(lit.normal, eye), 0);
  const albedos = (f0) => engine.albedos(f0, lit.baseRoughness, cosine);
  const dielectric = albedos(0.04);
  return baseColorFactor.slice(0, 3).map((colour, c) => {
    const metal = albedos(colour);
    const [once, between] = dielectric.map((albedo, i) => albedo + metalness * (metal[i] - albedo));
    const diffuse = colour * (1 - metalness) * (1 - dielectric[0] - dielectric[1]);
    return once * reflection[c] + (between + diffuse) * irradiance[c];
  });
}

/**
 * Draws a plane under an environment: RGB of each pixel, or null where the plane is not seen.
 *
 * @param {(places: number[][]) => Promise<number[][]>} lookUp Looks the prefiltered environment of the engine up, at
 *   directions with the share of the last level.
 */
export async function picture(asset, view, lookUp) {
  const { material, engine, method } = asset;
  const seen = points(asset, view);
  const several = isAnisotropic(material) && method.count > 1;
  const places = seen.map((point) => {
    if (!point) return [];
    const { normals, roughness } = several ? reader.lookUps(point.lit, method) : reader.lookUp(point.lit);
    const opposite = point.lit.normal.map((value) => -value);
    const reflections = normals.map((normal) => engine.reflected(point.eye, normal, roughness));
    return [[...point.lit.normal, 1], [...opposite, 1], ...reflections];
  });
  const found = await lookUp(places.flat());
  let next = 0;
  return seen.map((point, i) => {
    if (!point) return null;
    const [above, below, ...reflections] = found.slice(next, (next += places[i].length));
    const { meanNormal: length } = point.lit;
    const irradiance = above.map((value, c) => (value + below[c]) / 2 + (length * (value - below[c])) / 2);
    return radiance(point, material.pbrMetallicRoughness, mean(reflections), irradiance, engine);
  });
}
