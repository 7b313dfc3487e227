// The page: takes a .glb, bakes it, shows both, and offers the result.
import { Baker } from './baker.js';
import { headline, notes, rows } from './facts.js';
import { control } from './input.js';
import { Stage } from './stage.js';

const element = (id) => document.getElementById(id);
const form = element('form');
const status = element('status');
const baker = new Baker();
const stage = new Stage(element('canvas'), (samples, errors) => {
  const measured = Object.entries(errors).filter(([, error]) => error !== null);
  const text = measured.map(([name, error]) => `${name} ${error.toFixed(3)}`).join(', ');
  element('samples').textContent = samples ? `${samples} samples per pixel${text && `; error: ${text}`}` : '';
});

/** The file that is shown: its name without extension, and its bytes. */
let file = null;
let link = '';

/** Returns the settings that the form has. */
function settings() {
  const { engine, quality } = Object.fromEntries(new FormData(form));
  return { quality, ...(engine && { engine }), gltf: 'strict' };
}

/** Bakes the file that is shown. */
async function bake() {
  if (!file) return;
  const { name, bytes } = file;
  document.body.dataset.state = 'busy';
  element('download').hidden = true;
  status.textContent = `Baking ${name}.glb …`;
  element('progress').value = 0;
  try {
    const baked = await baker.bake(bytes, name, settings(), (share) => (element('progress').value = share));
    if (!baked) return;
    await stage.show({ before: bytes, baked: baked.bytes });
    report(baked);
    offer(baked.bytes, `${name}.baked.glb`);
    document.body.dataset.state = 'done';
  } catch (error) {
    fail(error);
  }
}

/** Takes a new file, shows it, and bakes it. */
async function take(name, bytes) {
  try {
    if (String.fromCharCode(...bytes.subarray(0, 4)) !== 'glTF') {
      throw new Error(`${name}: expected a .glb, found something else; pack a .gltf with its files into a .glb first`);
    }
    file = { name: name.replace(/\.glb$/i, ''), bytes };
    element('facts').hidden = true;
    await stage.show({ before: bytes });
    await bake();
  } catch (error) {
    fail(error);
  }
}

function fail(error) {
  document.body.dataset.state = 'failed';
  status.textContent = error.message;
}

function report(baked) {
  status.textContent = headline(file.bytes.byteLength, baked);
  const cell = (text, index) => Object.assign(document.createElement(index ? 'td' : 'th'), { textContent: text });
  const row = (cells) => {
    const line = document.createElement('tr');
    line.append(...cells.map(cell));
    line.firstChild.scope = 'row';
    return line;
  };
  const lines = rows(baked.report);
  element('rows').replaceChildren(...lines.map(row));
  const items = notes(baked.report).map((text) => Object.assign(document.createElement('li'), { textContent: text }));
  element('notes').replaceChildren(...items);
  element('asks').hidden = items.length === 0;
  element('facts').hidden = lines.length === 0;
}

function offer(bytes, name) {
  URL.revokeObjectURL(link);
  link = URL.createObjectURL(new Blob([bytes], { type: 'model/gltf-binary' }));
  Object.assign(element('download'), { href: link, download: name, hidden: false });
}

async function takeSample(name) {
  const response = await fetch(`samples/${name}.glb`);
  if (!response.ok) return fail(new Error(`expected the sample ${name}, found ${response.status}`));
  return take(`${name}.glb`, new Uint8Array(await response.arrayBuffer()));
}

async function takeFile(chosen) {
  if (!chosen) return;
  // A person wants to see the own model first, and a sample is clearest on a plane.
  form.elements.sample.value = '';
  form.elements.kind.value = 'asset';
  stage.set({ kind: 'asset' });
  await take(chosen.name, new Uint8Array(await chosen.arrayBuffer()));
}

/** Names of the variants for a person. */
const NAMES = { before: 'Before', baked: 'Baked', supersampled: 'Truth (supersampled)' };

/** Shows where the divider is and what is on its sides. */
function label() {
  const { split, left, right } = stage.view;
  element('split').value = Math.round(split * 1000);
  element('left-label').textContent = NAMES[left];
  element('right-label').textContent = NAMES[right];
  element('left-label').style.opacity = split > 0.12 ? 1 : 0;
  element('right-label').style.opacity = split < 0.88 ? 1 : 0;
  element('frame').style.setProperty('--split', split);
}

control(element('canvas'), stage, label);
element('split').addEventListener('input', (event) => {
  stage.set({ split: event.target.value / 1000 });
  label();
});
for (const name of ['left', 'right', 'kind']) {
  form.elements[name].addEventListener('change', (event) => {
    stage.set({ [name]: event.target.value });
    label();
  });
}
for (const name of ['engine', 'quality']) form.elements[name].addEventListener('change', bake);
form.addEventListener('submit', (event) => event.preventDefault());
element('file').addEventListener('change', (event) => takeFile(event.target.files[0]));
form.elements.sample.addEventListener('change', (event) => event.target.value && takeSample(event.target.value));
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

label();
await takeSample(form.elements.sample.value || 'brushed');
