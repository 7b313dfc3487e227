// One scene, drawn from one camera: before, baked, and the supersampled truth.
import * as THREE from 'three';
import { newLoader } from './loader.js';
import { Screen } from './screen.js';
import { Meter } from './viewer/measure.js';
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

export class Stage {
  #scene = new THREE.Scene();
  #camera = new THREE.PerspectiveCamera(30, 1, 0.01, 1000);
  #assets = new Map();
  #subjects = new Map();
  #pictures = new Map();
  #isStale = true;
  #changedAt = 0;
  #isRequested = false;
  #errors = {};
  #measuredAt = 0;

  /** `onFrame` takes the number of samples of the truth, and the error of each other picture once it is measured. */
  constructor(canvas, onFrame) {
    this.onFrame = onFrame;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: false });
    this.screen = new Screen(this.renderer);
    this.renderer.setClearColor(0x000000, 0);
    this.truth = new Accumulator(this.renderer);
    this.meter = new Meter(this.renderer);
    this.load = newLoader(this.renderer);
    this.view = { kind: 'plane', distance: 6, azimuth: 20, elevation: 20, split: 0.5, left: 'before', right: 'baked' };
    const lamp = new THREE.DirectionalLight(0xffffff, 3);
    lamp.position.copy(direction(160, 40));
    this.#scene.add(lamp);
    this.#scene.environment = surroundings(this.renderer, 'room');
    new ResizeObserver(() => this.set({})).observe(canvas);
  }

  /** Takes the assets: `before`, and `baked` where it is there. */
  async show({ before, baked }) {
    this.#assets = new Map();
    if (before) this.#assets.set('before', await this.load(before));
    if (baked) this.#assets.set('baked', await this.load(baked));
    this.#arrange();
  }

  /** Changes members of the view. */
  set(change) {
    Object.assign(this.view, change);
    if ('kind' in change) this.#arrange();
    // A divider that moves needs no new pictures; an empty change means another size.
    const names = Object.keys(change);
    if (names.length === 0 || names.some((name) => !['split', 'left', 'right'].includes(name)))
      [this.#isStale, this.#changedAt] = [true, performance.now()];
    this.#request();
  }

  #arrange() {
    for (const object of this.#subjects.values()) object.removeFromParent();
    this.#subjects = new Map([...this.#assets].map(([name, scene]) => [name, subject(scene, this.view.kind)]));
    const before = this.#subjects.get('before');
    if (before) this.#subjects.set('supersampled', unfiltered(before));
    for (const object of this.#subjects.values()) this.#scene.add(object);
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
    const { view, truth } = this;
    if (this.#isStale) this.#draw();
    const isNeeded = [view.left, view.right].includes('supersampled') && this.#subjects.has('supersampled');
    const isRunning = isNeeded && truth.count < ENOUGH;
    if (isRunning) {
      this.#only('supersampled');
      truth.add(this.#scene, this.#camera, performance.now() - this.#changedAt < PAUSE ? 1 : AT_ONCE);
      this.#measure();
    }
    const picture = (name) =>
      name === 'supersampled'
        ? { texture: truth.texture, samples: truth.count }
        : { texture: (this.#pictures.get(name) ?? this.#pictures.get('before')).texture, samples: 1 };
    this.screen.show(picture(view.left), picture(view.right), view.split);
    this.onFrame(isNeeded ? truth.count : 0, this.#errors);
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

  /** Draws the variants again. */
  #draw() {
    [this.#isStale, this.#errors, this.#measuredAt] = [false, {}, 0];
    const { clientWidth, clientHeight } = this.renderer.domElement;
    const ratio = Math.min(devicePixelRatio, 2);
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(clientWidth, clientHeight, false);
    const [width, height] = [clientWidth, clientHeight].map((size) => Math.max(1, Math.round(size * ratio)));
    const { distance, azimuth, elevation } = this.view;
    // 30 degrees along the shorter side.
    const half = Math.tan(THREE.MathUtils.degToRad(15)) * Math.max(1, height / width);
    this.#camera.fov = THREE.MathUtils.radToDeg(2 * Math.atan(half));
    this.#camera.aspect = width / height;
    this.#camera.updateProjectionMatrix();
    this.#camera.position.copy(direction(azimuth, elevation)).multiplyScalar(distance);
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

function direction(azimuth, elevation) {
  const [a, e] = [azimuth, elevation].map(THREE.MathUtils.degToRad);
  return new THREE.Vector3(Math.sin(a) * Math.cos(e), Math.sin(e), Math.cos(a) * Math.cos(e));
}
