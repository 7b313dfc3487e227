// The first view of the viewer and of the page to try the tool: where the camera stands, and how often maps repeat.
import { MathUtils } from 'three';
import { texelsPerUnit } from './density.js';
import { subject } from './subject.js';

/** Half of the field of view along the shorter side of a picture, in radians. */
const ANGLE = MathUtils.degToRad(15);
/** Tangent of half of the field of view along the shorter side: 30 degrees in all. */
export const HALF = Math.tan(ANGLE);

/**
 * Texels that a pixel covers along each side at first. A bake restores the roughness of bumps that are smaller than a
 * pixel, and at 6 texels engines sample levels 2 and 3. Planes and spheres fill the picture, and repeat their maps
 * until a pixel covers so many texels. The maps of an asset repeat as its document says, so the camera moves away until
 * then. It stays so near that the longest side of the asset takes at least a third of the picture, and so far that the
 * whole asset is in the picture. Small maps may still show each of their bumps there. Then a bake has nothing to show.
 */
export const TEXELS = 6;
/** Distance of the camera from planes and spheres in units: they fill the picture. */
const FILLING = { plane: 4, sphere: 4.5 };
/** Least share of the shorter side of the picture that the longest side of an asset takes. */
const LEAST = 1 / 3;

/**
 * Returns the width of a pixel in the middle of the subject, in units.
 *
 * @param {number} distance of the camera in units
 * @param {number} pixels along the shorter side of the picture
 */
export const pixelWidth = (distance, pixels) => (2 * HALF * distance) / pixels;

/**
 * Returns the first distance of the camera in units, and the repeats of the maps where a subject leaves them open.
 *
 * @param {import('three').Object3D} scene what a loader returned
 * @param {'asset' | 'plane' | 'sphere'} kind of the subject
 * @param {number} pixels along the shorter side of the picture
 * @param {number} texels that a pixel covers along each side
 * @returns {{ distance: number, repeats: number | undefined }}
 */
export function first(scene, kind, pixels, texels = TEXELS) {
  const single = subject(scene, kind, 1);
  const density = texelsPerUnit(single);
  if (kind === 'asset') return { distance: away(single.userData.size, density, pixels), repeats: undefined };
  const distance = FILLING[kind];
  return { distance, repeats: density > 0 ? texels / (density * pixelWidth(distance, pixels)) : undefined };
}

/** Returns the texels that a pixel covers along each side in the first view of a subject. */
function texelsAtFirst(scene, kind, pixels) {
  const { distance, repeats } = first(scene, kind, pixels);
  return texelsPerUnit(subject(scene, kind, repeats)) * pixelWidth(distance, pixels);
}

/**
 * Returns the subject that is seen first in a picture of `pixels` along its shorter side: the sphere if a pixel covers
 * less than one texel of the asset, so that engines sample no mip level there, and if more texels fit on the sphere.
 *
 * @param {import('three').Object3D} scene what a loader returned
 * @returns {'asset' | 'sphere'}
 */
export function firstKind(scene, pixels) {
  const onAsset = texelsAtFirst(scene, 'asset', pixels);
  return 0 < onAsset && onAsset < 1 && texelsAtFirst(scene, 'sphere', pixels) > onAsset ? 'sphere' : 'asset';
}

/** Returns the first distance from an asset of a size, whose surfaces have `density` texels along a unit. */
function away(size, density, pixels) {
  const nearest = size.length() / 2 / Math.sin(ANGLE);
  const farthest = Math.max(...size) / LEAST / (2 * HALF);
  const wanted = density > 0 ? TEXELS / (density * pixelWidth(1, pixels)) : farthest;
  return Math.max(nearest, Math.min(wanted, farthest));
}
