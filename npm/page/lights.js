// The lights of the scene: a room, and lamps in it.
import * as THREE from 'three';
import { direction } from './viewer/direction.js';

/** Irradiance of all lamps together. */
const INTENSITY = 3;

/** Lamps by name, each as azimuth and elevation in degrees. The room is always there. */
const LAMPS = {
  room: [],
  lamp: [[160, 40]],
  lamps: [
    [20, 25],
    [80, 40],
    [140, 60],
    [200, 25],
    [260, 40],
    [320, 60],
  ],
};

/** Returns the lamps of a name as one object of the scene. */
export function lamps(name) {
  const group = new THREE.Group();
  for (const [azimuth, elevation] of LAMPS[name]) {
    const lamp = new THREE.DirectionalLight(0xffffff, INTENSITY / LAMPS[name].length);
    lamp.position.copy(direction(azimuth, elevation));
    group.add(lamp);
  }
  return group;
}
