// Directions in the scene.
import { MathUtils, Vector3 } from 'three';

/** Returns the direction of an azimuth and an elevation in degrees. */
export function direction(azimuth, elevation) {
  const [a, e] = [azimuth, elevation].map(MathUtils.degToRad);
  return new Vector3(Math.sin(a) * Math.cos(e), Math.sin(e), Math.cos(a) * Math.cos(e));
}
