// A picture of a plane with ROUGHCAST_materials_roughness_pyramid, drawn as docs/extension/README.md describes it and
// by glTF's equations. It shares no code with the plugin.
import * as reader from './extension_reader.js';
import { transformed, trilinear } from './extension_texture.js';
import { met, ray, surface } from './plane.js';
import { dot, normalised, sum } from './vectors.js';

/** Returns the lobe that K is added to ("The lobe"), in a frame, and its roughness. */
function baseLobe(material, { e1, e2 }, { t, b }, texel, leastRoughness) {
  const { [reader.EXTENSION]: extension, KHR_materials_anisotropy: core } = material.extensions;
  const base = extension.baseLobe ?? { ...material.pbrMetallicRoughness, anisotropy: core };
  const { roughnessFactor = 1, metallicRoughnessTexture, anisotropy = {} } = base;
  const { anisotropyStrength = 0, anisotropyRotation = 0, anisotropyTexture } = anisotropy;
  const [red, green, blue] = anisotropyTexture ? texel(anisotropyTexture) : [1, 0.5, 1];
  const [x, y] = normalised([2 * red - 1, 2 * green - 1]);
  const [c, s] = [Math.cos(anisotropyRotation), Math.sin(anisotropyRotation)];
  const direction = sum([t, x * c - y * s], [b, x * s + y * c]);
  const factor = metallicRoughnessTexture ? texel(metallicRoughnessTexture)[1] : 1;
  const roughness = Math.max(roughnessFactor * factor, leastRoughness);
  const along = [dot(direction, e1), dot(direction, e2)];
  return { roughness, lobe: reader.baseLobe(roughness, anisotropyStrength * blue, along) };
}

/** Returns what is lit at a point of a plane. `texel` samples the texture of a textureInfo there. */
function point({ material, engine: { leastRoughness } }, surfaceThere, texel) {
  const extension = material.extensions[reader.EXTENSION];
  const frame = reader.frame(extension, surfaceThere);
  const normal = reader.normal(frame, reader.slopes(extension, texel(extension.offsetTexture)));
  const lost = extension.roughnessTexture && texel(extension.roughnessTexture);
  const k = reader.scaledCovariance(frame, reader.covariance(extension, lost));
  const { roughness, lobe } = baseLobe(material, frame, surfaceThere, texel, leastRoughness);
  const { alphas, axis } = reader.parameters(reader.roughened(extension, lobe, k), roughness ** 4);
  const axes = reader.axes(frame, normal, axis);
  const parts = reader.parts(extension, lobe, k, axis);
  const meanNormal = reader.meanNormal(extension, k);
  return { normal, axes, alphas, ...parts, baseRoughness: roughness, meanNormal };
}

/** Returns the radiance of a lit point ("Lights"): RGB. */
function radiance(lit, { baseColorFactor, metallicFactor: metalness }, eye, { direction, irradiance }, engine) {
  const weight = engine.fresnelWeight(dot(normalised(sum([eye, 1], [direction, 1])), eye));
  const fresnel = (f0) => f0 + (1 - f0) * weight;
  const [towardsEye, towardsLight] = [eye, direction].map((w) => Math.max(dot(lit.normal, w), 0));
  const lobe = reader.specular(lit, eye, direction);
  return baseColorFactor.slice(0, 3).map((colour) => {
    const f0 = 0.04 + metalness * (colour - 0.04);
    const specular = fresnel(f0) * lobe * engine.betweenFacets(f0, lit.baseRoughness, towardsEye);
    const diffuse = ((1 - metalness) * (1 - fresnel(0.04)) * colour) / Math.PI;
    return irradiance * (specular + towardsLight * lit.meanNormal * diffuse);
  });
}

/**
 * Returns what is lit at each pixel of a plane, and the direction to the eye, row by row from the bottom, or null where
 * the plane is not seen. `textures` has the levels and the wrap mode of each texture of the document.
 */
export function points(asset, { size, camera }) {
  const { material, plane, textures, engine } = asset;
  const surfaceThere = surface(plane, material.extensions[reader.EXTENSION].offsetTexture);
  const through = (i, j) => ray(camera, [(i + 0.5) / size, (j + 0.5) / size]);
  const at = (i, j) => met(plane, camera.eye, through(i, j));
  return Array.from({ length: size * size }, (_, pixel) => {
    const [i, j] = [pixel % size, Math.floor(pixel / size)];
    if (at(i, j).some((value) => value < 0 || value > plane.repeats)) return null;
    const texel = (info) => {
      // GPUs take derivatives between the pixels of a block of 2 x 2.
      const block = [at(i & ~1, j & ~1), at(i | 1, j & ~1), at(i & ~1, j | 1)].map((uv) => transformed(info, uv));
      const derivatives = [block[1], block[2]].map((end) => sum([end, 1], [block[0], -1]));
      return trilinear(textures[info.index], transformed(info, at(i, j)), derivatives, engine.level);
    };
    const lit = point(asset, surfaceThere, texel);
    const eye = through(i, j).map((value) => -value);
    return { lit: dot(surfaceThere.n, eye) < 0 ? reader.behind(lit) : lit, eye };
  });
}

/** Draws a plane under one directional light: RGB of each pixel, or null, as `points` has them. */
export function picture(asset, view) {
  const light = { ...view.light, direction: normalised(view.light.direction) };
  const { pbrMetallicRoughness } = asset.material;
  return points(asset, view).map(
    (seen) => seen && radiance(seen.lit, pbrMetallicRoughness, seen.eye, light, asset.engine),
  );
}
