// One scene, drawn from one camera: before, baked, and the supersampled truth.
import * as THREE from 'three';
import { lamps } from './lights.js';
import { newLoader } from './loader.js';
import { Screen, places } from './screen.js';
import { texturesOf } from './viewer/bytes.js';
import { texelsPerUnit } from './viewer/density.js';
import { direction } from './viewer/direction.js';
import { Meter } from './viewer/measure.js';
import { HALF, TEXELS, first, pixelWidth } from './viewer/start.js';
import { subject } from './viewer/subject.js';
import { Accumulator, unfiltered } from './viewer/supersample.js';
import { surroundings } from './viewer/surroundings.js';

/** Samples per pixel of the truth, and samples per frame while nothing moves. */
const [ENOUGH, AT_ONCE] = [256, 4];
/** Samples per pixel of the other pictures, as an engine with multisampling draws them. */
const MULTISAMPLES = 4;
/** Samples per pixel of the truth at which errors are measured. */
const MEASURED_AT = [32, ENOUGH];
/** Milliseconds without a change before several samples are drawn at once. */
const PAUSE = 150;
/**
 * What the distances mean. Maps repeat so often on a plane or a sphere that a pixel covers so many `texels`. The camera
 * is so many `times` as far away from a model as in the first view of the viewer.
 */
const DISTANCES = {
  near: { texels: 0.5, times: 0.5 },
  middle: { texels: TEXELS, times: 1 },
  far: { texels: 24, times: 2 },
};

/** Members of the view that need no new pictures, and those that change what is in the scene. */
const ONLY_SHOWN = ['split', 'left', 'right'];
const ARRANGED = ['kind', 'distance', 'light', 'layout'];

export class Stage {
  #scene = new THREE.Scene();
  #camera = new THREE.PerspectiveCamera(30, 1, 0.01, 1000);
  #lamps = new THREE.Group();
  #assets = new Map();
  #subjects = new Map();
  #pictures = new Map();
  #density = 0;
  #isStale = true;
  #changedAt = 0;
  #isRequested = false;
  #errors = {};
  #measuredAt = 0;

  /**
   * `onFrame` takes the places of the pictures, whether there is a bake, the number of samples of the truth, the error
   * of each other picture once it is measured, and how many texels a pixel covers.
   */
  constructor(canvas, view, onFrame) {
    Object.assign(this, { view, onFrame });
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: false });
    this.screen = new Screen(this.renderer);
    this.renderer.setClearColor(0x000000, 0);
    this.truth = new Accumulator(this.renderer);
    this.meter = new Meter(this.renderer);
    this.load = newLoader(this.renderer);
    this.#scene.environment = surroundings(this.renderer, 'room');
    new ResizeObserver(() => this.set({})).observe(canvas);
    this.#arrange();
  }

  /** Takes what the loader returned for the document `before` the bake, which drops the other one, or `baked`. */
  show(name, scene) {
    const names = name === 'before' ? [...this.#assets.keys()] : [name];
    for (const old of names) this.#remove(old);
    this.#assets.set(name, scene);
    if (name === 'before') this.view.radius = null;
    this.#arrange();
  }

  /** Drops the bake: the picture `baked` shows the original again. */
  dropBake() {
    this.#remove('baked');
    this.#arrange();
  }

  /** Calls `onFrame` again, with the same pictures. */
  refresh() {
    this.#request();
  }

  /** Frees the memory that an asset has on the GPU. */
  #remove(name) {
    const scene = this.#assets.get(name);
    if (!scene) return;
    for (const texture of texturesOf(scene)) texture.dispose();
    scene.traverse((object) => object.geometry?.dispose());
    this.#assets.delete(name);
  }

  /** Changes members of the view. An empty change means another size. */
  set(change) {
    Object.assign(this.view, change);
    const names = Object.keys(change);
    if (names.includes('kind') || names.includes('distance')) this.view.radius = null;
    if (names.some((name) => ARRANGED.includes(name))) this.#arrange();
    else if (names.length === 0 || !names.every((name) => ONLY_SHOWN.includes(name))) this.#expire();
    else this.#request();
  }

  /** Puts the subjects and lamps of the view into the scene. A camera without a radius gets its first one. */
  #arrange() {
    const { kind, distance, light } = this.view;
    this.#lamps.removeFromParent();
    this.#lamps = lamps(light);
    this.#scene.add(this.#lamps);
    for (const object of this.#subjects.values()) object.removeFromParent();
    this.#subjects.clear();
    const before = this.#assets.get('before');
    if (before) {
      const { texels, times } = DISTANCES[distance];
      const { distance: start, repeats } = first(before, kind, this.#pixels, texels);
      this.view.radius ??= kind === 'asset' ? times * start : start;
      this.#subjects = new Map([...this.#assets].map(([name, scene]) => [name, subject(scene, kind, repeats)]));
      this.#density = texelsPerUnit(this.#subjects.get('before'));
      this.#subjects.set('supersampled', unfiltered(this.#subjects.get('before')));
      this.#scene.add(...this.#subjects.values());
    }
    this.#expire();
  }

  /** Pixels along the shorter side of a picture. */
  get #pixels() {
    const [, , width, height] = this.#places()[0].box;
    return Math.min(width, height) * this.#ratio;
  }

  get #ratio() {
    return Math.min(devicePixelRatio, 2);
  }

  #places() {
    const { clientWidth, clientHeight } = this.renderer.domElement;
    return places(this.view, clientWidth, clientHeight);
  }

  /** Notes that the pictures do not show the scene any more. */
  #expire() {
    [this.#isStale, this.#changedAt] = [true, performance.now()];
    this.#request();
  }

  #request() {
    if (this.#isRequested) return;
    this.#isRequested = true;
    requestAnimationFrame(() => {
      this.#isRequested = false;
      this.#frame();
    });
  }

  #frame() {
    const { truth } = this;
    const shown = this.#places();
    if (this.#isStale) this.#draw(shown[0].box);
    const isNeeded = shown.some(({ name }) => name === 'supersampled') && this.#subjects.has('supersampled');
    const isRunning = isNeeded && truth.count < ENOUGH;
    if (isRunning) {
      this.#only('supersampled');
      truth.add(this.#scene, this.#camera, performance.now() - this.#changedAt < PAUSE ? 1 : AT_ONCE);
      this.#measure();
    }
    this.screen.show(shown, (name) =>
      name === 'supersampled'
        ? { texture: truth.texture, samples: Math.max(truth.count, 1) }
        : { texture: this.#pictures.get(name).texture, samples: 1 },
    );
    this.onFrame({
      places: shown,
      isBaked: this.#assets.has('baked'),
      samples: isNeeded ? truth.count : 0,
      errors: this.#errors,
      texels: this.#density * pixelWidth(this.view.radius, this.#pixels),
    });
    if (isRunning) this.#request();
  }

  /** Measures the error of both variants when the truth has enough samples. */
  #measure() {
    const { truth } = this;
    const due = MEASURED_AT.findLast((samples) => truth.count >= samples) ?? 0;
    if (due === this.#measuredAt) return;
    this.#measuredAt = due;
    const picture = { texture: truth.texture, samples: truth.count };
    for (const name of this.#assets.keys()) {
      this.#errors[name] = this.meter.relativeL1({ texture: this.#pictures.get(name).texture, samples: 1 }, picture);
    }
  }

  /** Draws the variants again, each as large as `box`. */
  #draw([, , boxWidth, boxHeight]) {
    [this.#isStale, this.#errors, this.#measuredAt] = [false, {}, 0];
    const { clientWidth, clientHeight } = this.renderer.domElement;
    this.renderer.setPixelRatio(this.#ratio);
    this.renderer.setSize(clientWidth, clientHeight, false);
    const [width, height] = [boxWidth, boxHeight].map((size) => Math.max(1, Math.round(size * this.#ratio)));
    const { radius, azimuth, elevation } = this.view;
    this.#camera.fov = THREE.MathUtils.radToDeg(2 * Math.atan(HALF * Math.max(1, height / width)));
    this.#camera.aspect = width / height;
    this.#camera.updateProjectionMatrix();
    this.#camera.position.copy(direction(azimuth, elevation)).multiplyScalar(radius);
    this.#camera.lookAt(0, 0, 0);
    for (const name of ['before', 'baked']) {
      if (!this.#pictures.has(name)) {
        const format = { type: THREE.HalfFloatType, samples: MULTISAMPLES };
        this.#pictures.set(name, new THREE.WebGLRenderTarget(1, 1, format));
      }
      const target = this.#pictures.get(name);
      target.setSize(width, height);
      this.#only(this.#subjects.has(name) ? name : 'before');
      this.renderer.setRenderTarget(target);
      this.renderer.render(this.#scene, this.#camera);
    }
    this.truth.reset(width, height);
  }

  #only(name) {
    for (const [key, object] of this.#subjects) object.visible = key === name;
  }
}
