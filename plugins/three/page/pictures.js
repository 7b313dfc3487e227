// The picture of each variant from the current camera, drawn only when it is needed and out of date.
import * as THREE from 'three';
import { Meter } from './measure.js';

/** Samples per pixel of edges. */
const MULTISAMPLES = 4;
const NEAREST = { minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter };

export class Pictures {
  #targets = new Map();
  /** Names of the pictures that show the current scene. */
  #current = new Set();
  /** All variants are drawn here and copied, since multisampled targets are large. */
  #multisampled = new THREE.WebGLRenderTarget(1, 1, { ...NEAREST, type: THREE.HalfFloatType, samples: MULTISAMPLES });
  #size = [1, 1];
  #meter;

  constructor(renderer, stage) {
    this.renderer = renderer;
    this.stage = stage;
    this.#meter = new Meter(renderer);
  }

  /** Sets the size in pixels. */
  resize(width, height) {
    this.#size = [width, height];
    this.#multisampled.setSize(width, height);
    for (const target of this.#targets.values()) target.dispose();
    this.#targets.clear();
    this.expire();
  }

  /** Drops all pictures, because the scene or the camera has changed. */
  expire() {
    this.#current.clear();
    this.stage.accumulator.reset(...this.#size);
  }

  /** Draws the pictures of `names` that are out of date. The truth is sampled by `sample`. */
  draw(names) {
    for (const name of names) {
      if (name === 'supersampled' || this.#current.has(name)) continue;
      if (!this.#targets.has(name)) this.#targets.set(name, this.#target());
      this.stage.draw(name, this.#multisampled);
      this.renderer.copyTextureToTexture(this.#multisampled.texture, this.#targets.get(name).texture);
      this.#current.add(name);
    }
  }

  #target() {
    const target = new THREE.WebGLRenderTarget(...this.#size, {
      ...NEAREST,
      type: THREE.HalfFloatType,
      depthBuffer: false,
    });
    this.renderer.initRenderTarget(target);
    return target;
  }

  /** Returns the number of samples per pixel of the truth. */
  get samples() {
    return this.stage.accumulator.count;
  }

  /** Adds samples per pixel to the truth. */
  sample(count) {
    this.stage.accumulate(count);
  }

  /** Returns a picture: a texture that is the sum of `samples` samples of linear radiance. */
  get(name) {
    if (name === 'supersampled') return { texture: this.stage.accumulator.texture, samples: Math.max(this.samples, 1) };
    return { texture: this.#targets.get(name).texture, samples: 1 };
  }

  /** Returns the error of each variant against the truth, by name. */
  errors(names) {
    this.draw(names);
    const truth = this.get('supersampled');
    return new Map(
      names
        .filter((name) => name !== 'supersampled')
        .map((name) => [name, this.#meter.relativeL1(this.get(name), truth)]),
    );
  }
}
