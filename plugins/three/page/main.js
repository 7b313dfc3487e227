// The page: draws again when a control, the camera or the turntable has changed something.
import * as THREE from 'three';
import { Controls } from './controls.js';
import { VIEWS, switches } from './debug.js';
import { footprint } from './density.js';
import { Divider } from './divider.js';
import { documents, listen as listenToDrops } from './drop.js';
import { Figures } from './figures.js';
import { Magnifier } from './magnifier.js';
import { Pictures } from './pictures.js';
import { listen as listenToPointers } from './pointer.js';
import { showScale } from './ramp.js';
import { Screen } from './screen.js';
import { Stage } from './stage.js';
import { Turntable } from './turntable.js';
import { TITLES, VARIANTS } from './variants.js';

/** Samples per pixel of the truth. */
const ENOUGH = 256;
/** Samples per pixel at which errors are measured: early for slow machines, and again when there are enough. */
const MEASURED_AT = [16, 64, ENOUGH];
/** Milliseconds without a change before the picture rests. */
const PAUSE = 150;
/** Largest anisotropy of the texture filter. */
const ANISOTROPY = 16;
/** Degrees of the camera per pixel of a drag, and pixels of the magnifier per key. */
const [PER_PIXEL, PER_KEY] = [0.4, 8];

/** Follows the texels that a pixel covers if these are less than one. */
const TOO_NEAR =
  'Few bumps are lost so near: a bake shows from farther away, or on the subject “Sphere”, which repeats the maps.';

/** Follows the texels that a pixel covers if the sphere was chosen in place of the asset. */
const ON_SPHERE = 'The maps are shown on a sphere, since a pixel covers less than one texel of the asset at first.';

const element = (id) => document.getElementById(id);
const [canvas, frame, status, play, loupe] = ['canvas', 'frame', 'status', 'play', 'loupe'].map(element);

const renderer = new THREE.WebGLRenderer({ canvas, antialias: false, alpha: false });
const stage = new Stage(renderer, { anisotropy: ANISOTROPY });
const pictures = new Pictures(renderer, stage);
const turntable = new Turntable();
const magnifier = new Magnifier({ tiles: element('tiles'), mark: element('mark') });
const divider = new Divider(element('divider'), () => request());
const screen = new Screen({
  renderer,
  frame,
  labels: element('labels'),
  background: new THREE.Color(0.02, 0.02, 0.022),
  divider,
  magnifier,
});
const figures = new Figures({ body: element('figures'), note: element('note') });
/** What is shown: bytes of each variant, and whether three.js draws it wrongly, by name. */
const assets = new Map();
let [isStale, changedAt, shape, measuredAt, mayStart, isRequested] = [true, 0, '', 0, false, false];
/** Whether the sphere was chosen in place of the asset, and no person has chosen a subject since. */
let isOnSphere = false;
showScale(element('scale'));

/** Notes that the pictures do not show the scene any more. */
function expire() {
  [isStale, changedAt] = [true, performance.now()];
  request();
}

/** What needs no new pictures. */
const ONLY_SHOWN = ['left', 'right', 'exposure'];
const controls = new Controls({
  form: element('controls'),
  canvas,
  keys: {
    '[': () => divider.step(-0.05),
    ']': () => divider.step(0.05),
    ' ': () => turn(!turntable.isTurning),
    m: () => magnify(!magnifier.isOn),
    'Shift+ArrowLeft': () => look(-PER_KEY, 0),
    'Shift+ArrowRight': () => look(PER_KEY, 0),
    'Shift+ArrowUp': () => look(0, -PER_KEY),
    'Shift+ArrowDown': () => look(0, PER_KEY),
  },
  changed: (name) => {
    if (name === 'subject') isOnSphere = false;
    if (name === 'subject' && assets.size > 0) present();
    if (ONLY_SHOWN.includes(name)) request();
    else expire();
  },
});

function turn(isTurning) {
  turntable.isTurning = isTurning;
  mayStart = false;
  play.setAttribute('aria-pressed', isTurning);
  play.textContent = isTurning ? '❚❚ Pause' : '▶ Turn';
  expire();
}

function magnify(isOn) {
  magnifier.isOn = isOn;
  loupe.setAttribute('aria-pressed', isOn);
  request();
}

/** Moves the magnifier. */
function look(dx, dy) {
  magnifier.move(dx, dy, screen.fit());
  request();
}

listenToPointers(canvas, {
  dragged: (dx, dy, kind) => {
    if (magnifier.isOn && kind === 'touch') return look(dx, dy);
    controls.step('azimuth', -PER_PIXEL * dx);
    controls.step('elevation', PER_PIXEL * dy);
  },
  hovered: (x, y) => {
    magnifier.at = { x, y };
    if (magnifier.isOn) request();
  },
  zoomed: (ratio) => controls.zoom(ratio),
});
play.addEventListener('click', () => turn(!turntable.isTurning));
loupe.addEventListener('click', () => magnify(!magnifier.isOn));

/** Returns what is to be shown, where, and the size of each picture in CSS pixels, of `ratio` screen pixels each. */
function arrangement() {
  const { ratio } = screen.fit();
  const what = { ...values('layout', 'left', 'right', 'view'), names: stage.variants };
  const places = screen.places(what);
  const [, , width, height] = places[0].box;
  return { what, places, width, height, ratio, shorter: Math.min(width, height) * ratio };
}

function draw(now) {
  turntable.advance(now);
  const { what, places, width, height, ratio, shorter } = arrangement();
  const wanted = [width, height, ratio].join();
  if (wanted !== shape) {
    shape = wanted;
    stage.resize(width, height);
    pictures.resize(Math.round(width * ratio), Math.round(height * ratio));
    isStale = true;
  }
  if (isStale || turntable.isTurning) place(shorter);
  divider.element.hidden = what.layout !== 'slider';
  element('scale').hidden = what.view !== 'difference';
  for (const pair of document.querySelectorAll('.pair')) pair.hidden = divider.element.hidden;

  const isMoving = turntable.isTurning || performance.now() - changedAt < PAUSE;
  pictures.draw(magnifier.isOn ? what.names : places.map(({ name }) => name));
  const hasTruth = what.names.includes('supersampled');
  const showsTruth = what.view === 'difference' || magnifier.isOn || places.some(({ name }) => name === 'supersampled');
  const isSampling = hasTruth && pictures.samples < ENOUGH && (!isMoving || showsTruth);
  if (isSampling) pictures.sample(Math.min(turntable.samples, ENOUGH - pictures.samples));
  if (!isMoving && hasTruth) measure(what);
  screen.show({
    pictures,
    places,
    names: what.names,
    view: what.view,
    exposure: 2 ** (controls.value('exposure') / 10),
    errorOf: (name) => figures.errorOf(name),
  });
  status.textContent = hasTruth && (showsTruth || !isMoving) ? state(isMoving) : '';
  if (isSampling || isMoving || turntable.isTurning) request();
  else turntable.rest();
}

const values = (...names) => Object.fromEntries(names.map((name) => [name, controls.value(name)]));

const state = (isMoving) =>
  isMoving ? `${pictures.samples} samples each frame` : `${pictures.samples} of ${ENOUGH} samples`;

/** Sets the scene up for pictures of `shorter` pixels along their shorter side, and drops the pictures. */
function place(shorter) {
  isStale = false;
  measuredAt = 0;
  stage.look({ distance: controls.distance, ...values('azimuth', 'elevation') });
  stage.turn(turntable.angle);
  const { environment, environmentIntensity, lightAzimuth, lightElevation, intensity, view, level } = values(
    'environment',
    'environmentIntensity',
    'lightAzimuth',
    'lightElevation',
    'intensity',
    'view',
    'level',
  );
  stage.environment(environment, environmentIntensity / 100);
  stage.light({ azimuth: lightAzimuth, elevation: lightElevation, intensity: intensity / 100 });
  switches.view.value = Math.max(VIEWS.indexOf(view), 0);
  switches.level.value = level;
  pictures.expire();
  figures.expire();
  const texels = stage.texelsOfPixel(controls.distance, shorter);
  const reason = 0 < texels && texels < 1 ? TOO_NEAR : isOnSphere ? ON_SPHERE : '';
  element('footprint').textContent = `${footprint(texels)} ${reason}`;
}

/** Measures errors whenever the truth is good enough to be worth it. The other views are no radiance. */
function measure({ names, view }) {
  const due = MEASURED_AT.findLast((samples) => pictures.samples >= samples) ?? 0;
  if (due === measuredAt || !['shaded', 'difference'].includes(view)) return;
  measuredAt = due;
  if (due > 0) figures.measured(pictures.errors(names), pictures.samples);
  if (due === ENOUGH && mayStart) turn(true);
}

function request() {
  if (isRequested || assets.size === 0) return;
  isRequested = true;
  requestAnimationFrame((now) => {
    isRequested = false;
    draw(now);
  });
}

/** Shows the subject from its first distance, unless the camera `isPlaced`. */
function present(isPlaced = false) {
  const distance = stage.showFirst(controls.value('subject'), arrangement().shorter);
  if (!isPlaced) controls.distance = distance;
}

/** Chooses the sphere where the first view of the asset would show no mip level. */
function choose() {
  const { subject } = element('controls').elements;
  isOnSphere = subject.value === 'asset' && stage.firstKind(arrangement().shorter) === 'sphere';
  if (isOnSphere) subject.value = 'sphere';
}

/** Shows sources by the name of the variant. An original replaces all that was shown before. */
async function open(sources, isPlaced = false) {
  const loaded = await Promise.all(
    Object.entries(sources).map(async ([name, source]) => [name, await stage.loader.load(source)]),
  );
  const isNew = 'original' in sources || assets.size === 0;
  if ('original' in sources) {
    for (const name of assets.keys()) stage.remove(name);
    assets.clear();
  }
  for (const [name, { scene, ...bytes }] of loaded) {
    stage.add(name, scene);
    assets.set(name, bytes);
  }
  const { variants } = stage;
  const entries = variants.map((name) => [name, TITLES[name]]);
  controls.options('left', entries, variants[0]);
  controls.options('right', entries, ['portable', 'pyramid', 'supersampled'].find((name) => variants.includes(name)));
  if (isNew && !isPlaced) choose();
  present(isPlaced || !isNew);
  figures.show(new Map(VARIANTS.filter((name) => assets.has(name)).map((name) => [name, assets.get(name)])));
  element('empty').hidden = true;
  expire();
}

/** Steps that load files follow each other, so that files which come while others load are shown after those. */
let earlier = Promise.resolve();
const attempt = (step) => (earlier = earlier.then(() => run(step)));

/** Runs a step that may fail, and says what failed. */
async function run(step) {
  status.textContent = 'Loading…';
  try {
    await step();
    element('problem').textContent = '';
  } catch (error) {
    status.textContent = '';
    element('problem').textContent = `Cannot be shown: ${error.message}`;
    request();
  }
}

listenToDrops(document.documentElement, element('files'), (given) =>
  attempt(async () => {
    const files = await given;
    const found = await documents(files);
    if (found.has('original')) element('controls').elements.subject.value = 'asset';
    await open(Object.fromEntries([...found].map(([name, file]) => [name, { file, files }])));
  }),
);

await attempt(async () => {
  // Browsers keep the values of controls when a page reloads.
  const isPlaced = controls.isChanged('distance');
  const { variants, subject } = await (await fetch('/view/variants.json')).json();
  if (!isPlaced) element('controls').elements.subject.value = subject;
  // The first thing that moves is the subject, unless a person asked for less motion or has moved something.
  mayStart = !matchMedia('(prefers-reduced-motion: reduce)').matches;
  for (const event of ['pointerdown', 'keydown']) addEventListener(event, () => (mayStart = false), { once: true });
  if (Object.keys(variants).length === 0) status.textContent = '';
  else await open(Object.fromEntries(Object.entries(variants).map(([name, url]) => [name, { url }])), isPlaced);
});
new ResizeObserver(request).observe(frame);
document.documentElement.dataset.ready = 'true';
new EventSource('/events').onmessage = () => location.reload();
