// One scene, drawn from one camera with each variant of the asset.
import * as THREE from 'three';
import { texturesOf } from './bytes.js';
import { debuggable } from './debug.js';
import { texelsPerUnit } from './density.js';
import { direction } from './direction.js';
import { Loader } from './loader.js';
import { HALF, first, firstKind, pixelWidth } from './start.js';
import { surroundings } from './surroundings.js';
import { bumpy, subject } from './subject.js';
import { Accumulator, unfiltered } from './supersample.js';
import { VARIANTS } from './variants.js';

/** Returns what belongs to the original or, without an original, to the first variant. */
const ofOriginal = (variants) => variants.get('original') ?? variants.values().next().value;

export class Stage {
  #assets = new Map();
  #subjects = new Map();
  /** Texels along a unit of the subject, once they are known. */
  #density = null;
  #scene = new THREE.Scene();
  #light = new THREE.DirectionalLight(0xffffff, 3);
  /** Carries the subjects. */
  #table = new THREE.Group();

  /** `anisotropy` is that of the filter of all variants' textures. Pixels that nothing covers are transparent. */
  constructor(renderer, { anisotropy = 1 } = {}) {
    this.renderer = renderer;
    this.renderer.setClearAlpha(0);
    this.camera = new THREE.PerspectiveCamera(30, 1, 0.01, 1000);
    this.accumulator = new Accumulator(renderer);
    this.loader = new Loader(renderer, anisotropy);
    this.#scene.add(this.#light, this.#light.target, this.#table);
    this.environment('room');
  }

  /**
   * Loads variants from URLs by name. `reflected` is an anisotropic portable bake, shaded with the plugin's
   * reflections.
   */
  async load(urls) {
    const load = async ([name, url]) => {
      this.add(name, (await this.loader.load({ url }, { reflections: name === 'reflected' })).scene);
    };
    await Promise.all(Object.entries(urls).map(load));
  }

  /** Adds what a loader returned as a variant, in place of the one that had the name. */
  add(name, scene) {
    this.remove(name);
    this.#assets.set(name, scene);
  }

  /** Removes a variant, and frees its memory on the GPU. */
  remove(name) {
    const scene = this.#assets.get(name);
    if (!scene) return;
    for (const texture of texturesOf(scene)) texture.dispose();
    scene.traverse((object) => object.geometry?.dispose());
    this.#assets.delete(name);
  }

  /** Returns the names of what can be drawn. The truth needs the original. */
  get variants() {
    return VARIANTS.filter((name) => this.#assets.has(name === 'supersampled' ? 'original' : name));
  }

  /** Returns the width of the original's normal map in texels. */
  get texels() {
    return bumpy(this.#assets.get('original')).normalMap.image.width;
  }

  /** Shows the asset, or a plane or a sphere with its material, and with `repeats` of the maps if given. */
  show(kind, repeats) {
    for (const object of this.#subjects.values()) object.removeFromParent();
    this.#density = null;
    this.#subjects = new Map([...this.#assets].map(([name, scene]) => [name, subject(scene, kind, repeats)]));
    const original = this.#subjects.get('original');
    if (original) this.#subjects.set('supersampled', unfiltered(original));
    for (const object of this.#subjects.values()) {
      object.traverse((mesh) => mesh.isMesh && debuggable(mesh.material));
      object.visible = false;
      this.#table.add(object);
    }
  }

  /** Returns the subject that is seen first in a picture of `pixels` along its shorter side. */
  firstKind(pixels) {
    return firstKind(ofOriginal(this.#assets), pixels);
  }

  /** Shows a subject as it is seen first, in a picture of `pixels` along its shorter side. Returns the distance. */
  showFirst(kind, pixels) {
    const { distance, repeats } = first(ofOriginal(this.#assets), kind, pixels);
    // The turntable shows the whole sphere, where the first repeat and the last one meet.
    this.show(kind, repeats && Math.max(Math.round(repeats), 1));
    return distance;
  }

  /** Returns how many texels a pixel covers along each side in the middle of the subject. */
  texelsOfPixel(distance, pixels) {
    this.#density ??= texelsPerUnit(ofOriginal(this.#subjects));
    return this.#density * pixelWidth(distance, pixels);
  }

  /** Places the camera. `distance` is in units of a subject about 2 units large, and angles are in degrees. */
  look({ distance, azimuth, elevation }) {
    this.camera.position.copy(direction(azimuth, elevation)).multiplyScalar(distance);
    this.camera.lookAt(0, 0, 0);
  }

  /** Turns the subject under the lights by an angle in degrees. */
  turn(angle) {
    this.#table.rotation.y = THREE.MathUtils.degToRad(angle);
  }

  light({ azimuth, elevation, intensity }) {
    this.#light.position.copy(direction(azimuth, elevation));
    this.#light.intensity = intensity;
  }

  environment(name, intensity = 1) {
    this.#scene.environment = surroundings(this.renderer, name);
    this.#scene.environmentIntensity = intensity;
  }

  /** Sets a field of view of 30 degrees along the shorter side. */
  resize(width, height) {
    this.camera.fov = THREE.MathUtils.radToDeg(2 * Math.atan(HALF * Math.max(1, height / width)));
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  /** Draws a variant with one sample per pixel, in linear radiance. */
  draw(name, target) {
    this.#only(name);
    this.renderer.setRenderTarget(target);
    this.renderer.render(this.#scene, this.camera);
    this.renderer.setRenderTarget(null);
  }

  /** Adds samples of the truth. */
  accumulate(samples) {
    this.#only('supersampled');
    this.accumulator.add(this.#scene, this.camera, samples);
  }

  #only(name) {
    for (const [key, object] of this.#subjects) object.visible = key === name;
  }
}
