// One scene, drawn from one camera with each variant of the asset.
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { KTX2Loader } from 'three/addons/loaders/KTX2Loader.js';
import { RoughcastPlugin } from 'three-roughcast';
import { debuggable } from './debug.js';
import { surroundings } from './surroundings.js';
import { subject } from './subject.js';
import { Accumulator, unfiltered } from './supersample.js';

/** Variants, in the order in which they are shown. */
export const VARIANTS = ['original', 'portable', 'pyramid', 'supersampled'];

export class Stage {
  #assets = new Map();
  #subjects = new Map();
  #scene = new THREE.Scene();
  #light = new THREE.DirectionalLight(0xffffff, 3);

  /** Without a `background`, pixels that nothing covers are black. */
  constructor(renderer, background = null) {
    this.renderer = renderer;
    this.camera = new THREE.PerspectiveCamera(30, 1, 0.01, 1000);
    this.accumulator = new Accumulator(renderer);
    this.#scene.add(this.#light, this.#light.target);
    this.#scene.background = background;
    this.environment('room');
  }

  /**
   * Loads the variants that have a URL. `reflected` is an anisotropic portable bake, shaded with the plugin's
   * reflections.
   */
  async load(urls) {
    const ktx2 = new KTX2Loader().setTranscoderPath('/three/examples/jsm/libs/basis/').detectSupport(this.renderer);
    const load = async ([name, url]) => {
      const plugin = (parser) => new RoughcastPlugin(parser, { reflections: name === 'reflected' });
      return [name, (await new GLTFLoader().setKTX2Loader(ktx2).register(plugin).loadAsync(url)).scene];
    };
    this.#assets = new Map(await Promise.all(Object.entries(urls).map(load)));
    ktx2.dispose();
  }

  /** Returns the names of what can be drawn. The truth needs the original. */
  get variants() {
    return VARIANTS.filter((name) => this.#assets.has(name === 'supersampled' ? 'original' : name));
  }

  /** Shows the asset, or a plane or a sphere with its material. */
  show(kind) {
    for (const object of this.#subjects.values()) object.removeFromParent();
    this.#subjects = new Map([...this.#assets].map(([name, scene]) => [name, subject(scene, kind)]));
    const original = this.#subjects.get('original');
    if (original) this.#subjects.set('supersampled', unfiltered(original));
    for (const object of this.#subjects.values()) {
      object.traverse((mesh) => mesh.isMesh && debuggable(mesh.material));
      object.visible = false;
      this.#scene.add(object);
    }
  }

  /** Places the camera. `distance` is in units of a subject about 2 units large, and angles are in degrees. */
  look({ distance, azimuth, elevation }) {
    this.camera.position.copy(direction(azimuth, elevation)).multiplyScalar(distance);
    this.camera.lookAt(0, 0, 0);
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
    const half = Math.tan(THREE.MathUtils.degToRad(15)) * Math.max(1, height / width);
    this.camera.fov = THREE.MathUtils.radToDeg(2 * Math.atan(half));
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

function direction(azimuth, elevation) {
  const [a, e] = [azimuth, elevation].map(THREE.MathUtils.degToRad);
  return new THREE.Vector3(Math.sin(a) * Math.cos(e), Math.sin(e), Math.cos(a) * Math.cos(e));
}
