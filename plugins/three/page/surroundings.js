// Environments, which are computed and not downloaded.
import * as THREE from 'three';
import { RoomEnvironment } from 'three/addons/environments/RoomEnvironment.js';

/** A sky that brightens towards a low sun, over dark ground. */
const SKY = /* glsl */ `
varying vec3 way;
void main() {
  vec3 d = normalize( way );
  vec3 sky = mix( vec3( 0.9, 0.75, 0.6 ), vec3( 0.15, 0.3, 0.7 ), sqrt( max( d.y, 0.0 ) ) );
  float toSun = max( dot( d, normalize( vec3( 0.6, 0.25, -0.75 ) ) ), 0.0 );
  sky += vec3( 6.0, 4.0, 2.0 ) * pow( toSun, 200.0 );
  gl_FragColor = vec4( mix( vec3( 0.08, 0.07, 0.06 ), sky, smoothstep( -0.02, 0.02, d.y ) ), 1.0 );
}`;

const sky = () =>
  new THREE.Scene().add(
    new THREE.Mesh(
      new THREE.SphereGeometry(10, 32, 16),
      new THREE.ShaderMaterial({
        side: THREE.BackSide,
        vertexShader: `
          varying vec3 way;
          void main() {
            way = position;
            gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
          }`,
        fragmentShader: SKY,
      }),
    ),
  );

/** Environments by name; `none` has no entry. */
export const ENVIRONMENTS = { room: () => new RoomEnvironment(), sky, none: null };

const made = new WeakMap();

/** Returns the prefiltered environment of a name. */
export function surroundings(renderer, name) {
  if (!ENVIRONMENTS[name]) return null;
  const known = made.get(renderer) ?? new Map();
  made.set(renderer, known);
  if (!known.has(name)) {
    const generator = new THREE.PMREMGenerator(renderer);
    known.set(name, generator.fromScene(ENVIRONMENTS[name](), 0.02).texture);
    generator.dispose();
  }
  return known.get(name);
}
