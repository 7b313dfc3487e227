// The page: draws again when a control changes.
import * as THREE from 'three';
import { Composer } from './compose.js';
import { Controls } from './controls.js';
import { VIEWS, switches } from './debug.js';
import { Stage } from './stage.js';

/** Samples per pixel of the truth, and samples per batch. */
const [ENOUGH, AT_ONCE] = [256, 4];
/** Milliseconds without a change before the truth is sampled. */
const PAUSE = 150;
const DIFFERENCE = 4;

const element = (id) => document.getElementById(id);
const [canvas, labels, split, status] = ['canvas', 'labels', 'split', 'status'].map(element);

const renderer = new THREE.WebGLRenderer({ canvas, antialias: false });
renderer.autoClear = true;
const stage = new Stage(renderer, new THREE.Color(0.02, 0.02, 0.022));
const composer = new Composer(renderer);
const pictures = new Map();
let [isStale, changedAt, layout] = [true, 0, null];

const controls = new Controls({
  form: element('controls'),
  canvas,
  split,
  changed: (name) => {
    if (name === 'subject') stage.show(controls.value('subject'));
    // A divider that moves needs no new pictures.
    if (!['split', 'left', 'right'].includes(name)) [isStale, changedAt] = [true, performance.now()];
    request();
  },
});

/** Returns boxes of the screen in CSS pixels from the lower left, and the windows that clip them. */
function places(width, height) {
  const names = stage.variants;
  if (controls.value('layout') === 'slider') {
    const x = Math.round((width * controls.value('split')) / 1000);
    const box = [0, 0, width, height];
    return [
      { name: controls.value('left'), box, window: [0, 0, x, height], label: x / 2 },
      { name: controls.value('right'), box, window: [x, 0, width - x, height], label: (x + width) / 2 },
    ];
  }
  const [columns, rows] =
    width > 1.2 * height ? [names.length, 1] : [Math.min(2, names.length), Math.ceil(names.length / 2)];
  const [w, h] = [Math.floor(width / columns), Math.floor(height / rows)];
  return names.map((name, i) => {
    const [column, row] = [i % columns, Math.floor(i / columns)];
    const box = [column * w, (rows - 1 - row) * h, w, h];
    return { name, box, window: box, label: column * w + w / 2, top: row * h };
  });
}

function frame() {
  const { clientWidth, clientHeight } = canvas.parentElement;
  const ratio = Math.min(devicePixelRatio, 2);
  const all = places(clientWidth, clientHeight);
  const [, , width, height] = all[0].box;
  const shape = [clientWidth, clientHeight, width, height, ratio].join();
  if (shape !== layout) {
    layout = shape;
    renderer.setPixelRatio(ratio);
    renderer.setSize(clientWidth, clientHeight, false);
    stage.resize(width, height);
    isStale = true;
  }
  const view = controls.value('view');
  switches.view.value = Math.max(VIEWS.indexOf(view), 0);
  if (isStale) draw(Math.round(width * ratio), Math.round(height * ratio));
  const needsTruth = view === 'difference' || all.some(({ name }) => name === 'supersampled');
  const isRunning = needsTruth && stage.variants.includes('supersampled') && stage.accumulator.count < ENOUGH;
  const isMoving = performance.now() - changedAt < PAUSE;
  if (isRunning) stage.accumulate(isMoving ? 1 : AT_ONCE);
  show(all, view);
  status.textContent = needsTruth ? `${stage.accumulator.count} samples per pixel` : '';
  if (isRunning) request();
}

/** Draws every variant again. */
function draw(width, height) {
  isStale = false;
  stage.look({
    distance: controls.distance,
    azimuth: controls.value('azimuth'),
    elevation: controls.value('elevation'),
  });
  stage.environment(controls.value('environment'), controls.value('environmentIntensity') / 100);
  const [azimuth, elevation, intensity] = ['lightAzimuth', 'lightElevation', 'intensity'].map((name) =>
    controls.value(name),
  );
  stage.light({ azimuth, elevation, intensity: intensity / 100 });
  switches.level.value = controls.value('level');
  for (const name of stage.variants.filter((variant) => variant !== 'supersampled')) {
    if (!pictures.has(name)) pictures.set(name, new THREE.WebGLRenderTarget(1, 1, { type: THREE.HalfFloatType }));
    pictures.get(name).setSize(width, height);
    stage.draw(name, pictures.get(name));
  }
  stage.accumulator.reset(width, height);
}

function show(all, view) {
  const truth = { texture: stage.accumulator.texture, samples: stage.accumulator.count };
  const index = view === 'difference' ? DIFFERENCE : switches.view.value;
  for (const { name, box, window } of all) {
    const picture = name === 'supersampled' ? truth : { texture: pictures.get(name).texture, samples: 1 };
    if (window[2] > 0) composer.draw(picture, truth, index, box, window);
  }
  split.hidden = controls.value('layout') !== 'slider';
  for (const pair of document.querySelectorAll('.pair')) pair.hidden = split.hidden;
  labels.replaceChildren(
    ...all.map(({ name, label, top }) => {
      const span = document.createElement('span');
      span.textContent = name;
      span.style.left = `${label}px`;
      if (top) span.style.top = `calc(${top}px + 0.6rem)`;
      return span;
    }),
  );
}

let isRequested = false;
function request() {
  if (isRequested) return;
  isRequested = true;
  requestAnimationFrame(() => {
    isRequested = false;
    frame();
  });
}

try {
  const { variants } = await (await fetch('/view/variants.json')).json();
  await stage.load(variants);
  stage.show(controls.value('subject'));
  const [first] = stage.variants;
  controls.options('left', stage.variants, first);
  controls.options(
    'right',
    stage.variants,
    ['pyramid', 'portable', 'supersampled'].find((name) => stage.variants.includes(name)),
  );
  new ResizeObserver(request).observe(canvas.parentElement);
  frame();
  document.documentElement.dataset.ready = 'true';
  // Browsers keep the values of controls when a page reloads.
  new EventSource('/events').onmessage = () => location.reload();
} catch (error) {
  status.textContent = `Cannot be shown: ${error.message}`;
  throw error;
}
