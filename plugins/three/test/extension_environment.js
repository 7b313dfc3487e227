// A picture of a plane with ROUGHCAST_materials_roughness_pyramid under an environment, drawn as
// docs/extension/README.md describes it. It shares no code with the plugin.
import { points } from './extension_picture.js';
import * as reader from './extension_reader.js';
import { dot, sum } from './vectors.js';

/** The method of the page: the number of look-ups, the share of the smaller spread in blur, a factor on the rest. */
export const METHOD = { count: 16, blur: 1 / 4, spread: 1.3 };
/** Returns the mean of colours. */
const mean = (colours) => sum(...colours.map((colour) => [colour, 1 / colours.length]));
/** Returns the mean of colours with weights in each channel. */
const weightedMean = (colours, weights) =>
  colours[0].map((_, c) => {
    const total = weights.reduce((total, weight) => total + weight[c], 0);
    return colours.reduce((total, colour, i) => total + weights[i][c] * colour[c], 0) / total;
  });

/** Returns whether the page has several look-ups for a material. */
function isAnisotropic({ extensions }) {
  const { [reader.EXTENSION]: extension, KHR_materials_anisotropy: core } = extensions;
  const { anisotropyStrength = 0 } = (extension.baseLobe ? extension.baseLobe.anisotropy : core) ?? {};
  return extension.roughnessModel === 'covarianceFactor' || anisotropyStrength > 0;
}

/** Returns the colours at which the surface reflects: F0 of each channel, which metalness blends. */
const reflectances = ({ baseColorFactor, metallicFactor }) =>
  baseColorFactor.slice(0, 3).map((colour) => 0.04 + metallicFactor * (colour - 0.04));

/**
 * Returns the radiance of a point ("Environments"), from numbers of the table of albedos, the mean reflection, and the
 * irradiance over pi: RGB.
 */
function radiance({ baseColorFactor, metallicFactor: metalness }, table, reflection, irradiance, engine) {
  const dielectric = engine.albedos(0.04, table);
  return baseColorFactor.slice(0, 3).map((colour, c) => {
    const metal = engine.albedos(colour, table);
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
  const looked = seen.map((point) => {
    if (!point) return null;
    const { normals, roughness } = several ? reader.lookUps(point.lit, method) : reader.lookUp(point.lit);
    const cosines = normals.map((normal) => Math.max(dot(normal, point.eye), 0));
    const tables = cosines.map((cosine) => engine.table(point.lit.baseRoughness, cosine));
    const opposite = point.lit.normal.map((value) => -value);
    const reflections = normals.map((normal) => engine.reflected(point.eye, normal, roughness));
    return { tables, places: [[...point.lit.normal, 1], [...opposite, 1], ...reflections] };
  });
  const found = await lookUp(looked.flatMap((look) => look?.places ?? []));
  let next = 0;
  return seen.map((point, i) => {
    if (!point) return null;
    const { tables, places } = looked[i];
    const [above, below, ...reflections] = found.slice(next, (next += places.length));
    const { meanNormal: length } = point.lit;
    const irradiance = above.map((value, c) => (value + below[c]) / 2 + (length * (value - below[c])) / 2);
    const { pbrMetallicRoughness: core } = material;
    const weights = tables.map((table) => reflectances(core).map((f0) => engine.albedos(f0, table)[0]));
    return radiance(core, mean(tables), weightedMean(reflections, weights), irradiance, engine);
  });
}
