// The page: takes a .glb, bakes it, shows both, and offers the result.
import { Baker } from './baker.js';
import { headline, layerRows, measured, notes, size, textureRows } from './facts.js';
import { control } from './input.js';
import { label } from './labels.js';
import { commandOf, nameOf, settingsOf } from './settings.js';
import { Stage } from './stage.js';
import { refusal } from './viewer/refusal.js';

const element = (id) => document.getElementById(id);
const form = element('form');
const status = element('status');
const baker = new Baker();

/** Members of the view that the form has. */
const VIEW = ['distance', 'layout', 'left', 'right', 'kind', 'light'];
/** Fields that change the bake. */
const OPTIONS = ['engine', 'textures', 'maxSize', 'quality', 'rdo'];

const view = { azimuth: 20, elevation: 35, split: 0.5 };
for (const name of VIEW) view[name] = form.elements[name].value;
const stage = new Stage(element('canvas'), view, (frame) => {
  label(element('labels'), frame, document.body.dataset.state === 'busy');
  element('measured').textContent = measured(frame.texels, frame.samples);
});

/** The file that is shown: its name without extension, and its bytes. */
let file = null;
/** Counts what has begun, so that what ends after a newer beginning is left out. */
let begun = 0;
/** Whether a file is being loaded. Once it is there, it is baked with the options that the form then has. */
let isLoading = false;
/** Whether the page shows what became of the file and the options of the form. */
let isCurrent = true;
let link = '';

/** Bakes the file that is shown. A `problem` of another file stays on the page. */
async function bake(problem = '') {
  if (!file) return;
  isCurrent = false;
  if (isLoading) return;
  const { name, bytes } = file;
  const mine = ++begun;
  const settings = settingsOf(form);
  for (const id of ['download', 'same']) element(id).hidden = true;
  wait([problem, `Baking ${name}.glb …`].filter(Boolean).join('. '));
  const advance = (share) => {
    if (mine === begun) element('progress').value = share;
  };
  try {
    const baked = await baker.bake(bytes, name, settings, advance);
    const scene = baked && (await stage.load(baked.bytes));
    if (mine !== begun) return;
    stage.show('baked', scene);
    report(baked);
    offer(baked.bytes, nameOf(name, settings));
    element('command').textContent = commandOf(name, settings);
    element('same').hidden = false;
    isCurrent = true;
    if (problem) say('failed', problem);
    else say('done', headline(bytes.byteLength, baked));
  } catch (error) {
    if (mine !== begun) return;
    isCurrent = true;
    // An earlier bake has other settings than the form.
    stage.dropBake();
    element('facts').hidden = true;
    fail(error);
  }
}

/**
 * Takes a promise of the bytes of a new file, shows it, and bakes it. If the file cannot be shown, the page keeps the
 * earlier one, and bakes that again if the options have changed or its bake was ended.
 */
async function take(name, content, { isOwn }) {
  const mine = ++begun;
  isLoading = true;
  wait(`Loading ${name} …`);
  try {
    const bytes = await content;
    if (mine !== begun) return;
    const scene = await stage.load(bytes);
    if (mine !== begun) return;
    file = { name: name.replace(/\.glb$/i, ''), bytes };
    element('facts').hidden = true;
    if (isOwn) {
      form.elements.sample.value = '';
      // A person wants to see the own model first, where a bake shows.
      change({ kind: 'asset', distance: 'middle' });
    }
    stage.show('before', scene);
  } catch (error) {
    if (mine !== begun) return;
    isLoading = false;
    if (isCurrent) fail(error);
    else await bake(error.message);
    return;
  }
  isLoading = false;
  await bake();
}

/** Says what is done now. The progress is unknown until the first report of it. */
function wait(text) {
  element('progress').removeAttribute('value');
  say('busy', text);
}

function fail(error) {
  say('failed', error.message);
}

/** Changes the state of the page and the text on it. The labels of the pictures depend on the state. */
function say(state, text) {
  document.body.dataset.state = state;
  status.replaceChildren(...withCode(text));
  stage.refresh();
}

/** Returns the nodes of a text, with code where it has backticks. */
function withCode(text) {
  return text
    .split('`')
    .map((part, index) => (index % 2 ? Object.assign(document.createElement('code'), { textContent: part }) : part));
}

/** Returns a row of a table, whose first cell is its header. */
function row(cells) {
  const line = document.createElement('tr');
  const cell = (text, index) => Object.assign(document.createElement(index ? 'td' : 'th'), { textContent: text });
  line.append(...cells.map(cell));
  line.firstChild.scope = 'row';
  return line;
}

function report(baked) {
  const lines = layerRows(baked.report);
  element('rows').replaceChildren(...lines.map(row));
  element('layers').hidden = lines.length === 0;
  element('textures').replaceChildren(...textureRows(baked.report).map(row));
  const items = notes(baked.report).map((text) => {
    const item = document.createElement('li');
    item.append(...withCode(text));
    return item;
  });
  element('notes').replaceChildren(...items);
  element('asks').hidden = items.length === 0;
  element('facts').hidden = baked.report.textures.length === 0;
}

function offer(bytes, name) {
  URL.revokeObjectURL(link);
  link = URL.createObjectURL(new Blob([bytes], { type: 'model/gltf-binary' }));
  const textContent = `Download the .glb, ${size(bytes.byteLength)}`;
  Object.assign(element('download'), { href: link, download: name, textContent, hidden: false });
}

const takeSample = (name) => take(`${name}.glb`, sample(name), { isOwn: false });

/** Returns the bytes of a sample. */
async function sample(name) {
  const response = await fetch(`samples/${name}.glb`);
  if (!response.ok) throw new Error(`expected the sample ${name}, found ${response.status}`);
  return new Uint8Array(await response.arrayBuffer());
}

function takeFile(chosen) {
  if (chosen) take(chosen.name, contentOf(chosen), { isOwn: true });
}

/** Returns the bytes of a file that a person has chosen. */
async function contentOf(chosen) {
  const bytes = new Uint8Array(await chosen.arrayBuffer());
  const reason = refusal(chosen.name, bytes);
  if (reason) throw new Error(`${chosen.name}: ${reason}`);
  if (String.fromCharCode(...bytes.subarray(0, 4)) !== 'glTF') {
    const remedy = 'pack a .gltf with its files into a .glb first';
    throw new Error(`${chosen.name}: expected a .glb, found something else; ${remedy}`);
  }
  return bytes;
}

/** Changes members of the view, and the fields of the form with them. */
function change(members) {
  // The size of the picture depends on the layout.
  document.body.dataset.layout = members.layout ?? view.layout;
  stage.set(members);
  for (const name of VIEW) form.elements[name].value = view[name];
  element('split').value = Math.round(view.split * 1000);
  element('frame').style.setProperty('--split', view.split);
}

control(element('canvas'), stage, change);
element('split').addEventListener('input', ({ target }) => change({ split: target.value / 1000 }));
form.addEventListener('change', ({ target: { name, value } }) => {
  if (VIEW.includes(name)) change({ [name]: value });
  if (OPTIONS.includes(name)) bake();
  if (name === 'sample' && value) takeSample(value);
});
form.addEventListener('submit', (event) => event.preventDefault());
// Pages without https have no clipboard, except on this machine.
element('copy').hidden = !navigator.clipboard;
element('copy').addEventListener('click', () => navigator.clipboard.writeText(element('command').textContent));
element('file').addEventListener('change', (event) => takeFile(event.target.files[0]));
addEventListener('dragover', (event) => {
  event.preventDefault();
  document.body.classList.add('over');
});
addEventListener('dragleave', () => document.body.classList.remove('over'));
addEventListener('drop', (event) => {
  event.preventDefault();
  document.body.classList.remove('over');
  takeFile(event.dataTransfer.files[0]);
});

change({});
await takeSample(form.elements.sample.value || 'brushed');
