// The truth: many samples per pixel of level 0, without filtering.
import * as THREE from 'three';

const SLOTS = [
  'map',
  'normalMap',
  'roughnessMap',
  'metalnessMap',
  'aoMap',
  'emissiveMap',
  'anisotropyMap',
  'clearcoatMap',
  'clearcoatNormalMap',
  'clearcoatRoughnessMap',
  'alphaMap',
];

/** Copies of textures that have level 0 only. */
const made = new WeakMap();

function finest(texture) {
  if (!made.has(texture)) {
    const copy = texture.clone();
    Object.assign(copy, { minFilter: THREE.LinearFilter, generateMipmaps: false, anisotropy: 1 });
    copy.needsUpdate = true;
    texture.addEventListener('dispose', () => copy.dispose());
    made.set(texture, copy);
  }
  return made.get(texture);
}

/** Returns `object` with materials that sample level 0 only. */
export function unfiltered(object) {
  const copies = new Map();
  const copy = object.clone();
  copy.traverse((mesh) => {
    if (!mesh.isMesh) return;
    if (!copies.has(mesh.material)) {
      const material = mesh.material.clone();
      for (const slot of SLOTS) if (material[slot]) material[slot] = finest(material[slot]);
      copies.set(mesh.material, material);
    }
    mesh.material = copies.get(mesh.material);
  });
  return copy;
}

/** Returns the n-th point of the R2 sequence of M. Roberts, 2018, which covers the unit square evenly. */
const point = (n) => [0.5 + n * 0.7548776662466927, 0.5 + n * 0.5698402909980532].map((c) => c % 1);

/** Averages samples that are drawn a few at a time. */
export class Accumulator {
  #sample = target();
  #sum = target();
  #quad;
  #camera = new THREE.Camera();

  constructor(renderer) {
    this.renderer = renderer;
    this.count = 0;
    const material = new THREE.ShaderMaterial({
      uniforms: { map: { value: this.#sample.texture } },
      vertexShader: 'varying vec2 at; void main() { at = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }',
      fragmentShader: 'uniform sampler2D map; varying vec2 at; void main() { gl_FragColor = texture2D(map, at); }',
      blending: THREE.CustomBlending,
      blendSrc: THREE.OneFactor,
      blendDst: THREE.OneFactor,
      depthTest: false,
      depthWrite: false,
      transparent: true,
    });
    this.#quad = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), material);
    this.#quad.frustumCulled = false;
  }

  get texture() {
    return this.#sum.texture;
  }

  get target() {
    return this.#sum;
  }

  /** Starts again. */
  reset(width, height) {
    this.count = 0;
    for (const t of [this.#sample, this.#sum]) t.setSize(width, height);
  }

  /** Adds `samples` pictures, in linear radiance. */
  add(scene, camera, samples) {
    const { renderer } = this;
    const { width, height } = this.#sum;
    const { autoClear } = renderer;
    for (let i = 0; i < samples; i++) {
      const [x, y] = point(this.count);
      camera.setViewOffset(width, height, x - 0.5, y - 0.5, width, height);
      renderer.setRenderTarget(this.#sample);
      renderer.render(scene, camera);
      renderer.setRenderTarget(this.#sum);
      renderer.autoClear = this.count === 0;
      renderer.render(this.#quad, this.#camera);
      renderer.autoClear = autoClear;
      this.count++;
    }
    camera.clearViewOffset();
    renderer.setRenderTarget(null);
  }
}

function target() {
  return new THREE.WebGLRenderTarget(1, 1, {
    type: THREE.FloatType,
    minFilter: THREE.NearestFilter,
    magFilter: THREE.NearestFilter,
  });
}
