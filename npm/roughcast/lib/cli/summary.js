// The outcomes of bakes as lines of text, as the native tool prints them (src/cli/terminal/summary.rs).
import { count } from './files.js';

/** Materials that a note names. Further materials are counted. */
const MAX_NAMED = 3;

/** Members of `sizes`, by the names that a person reads. */
const PARTS = { ktx2: 'KTX2', fallback: 'PNG copies', images: 'images', geometry: 'geometry', json: 'JSON' };

/** How much smaller the textures of a candidate are, by the level that becomes their level 0. */
const FRACTIONS = ['', ', half size', ', quarter size'];

/** Characters that a terminal or a log acts on, as `printable` of the pipeline has them. */
const ACTIVE = /[\p{Cc}\u2028\u2029\u202a-\u202e\u2066-\u2069]/gu;

/**
 * Returns a line about an asset that did not fail. With `verbose`, a line for each layer follows, with all of its
 * notes.
 */
export function summary(asset, verbose) {
  const line = `${asset.status} ${printable(asset.input)}: ${text(totalsOf(asset), asset.seconds)}`;
  return [line, ...(verbose ? asset.layers.flatMap(layerLines) : []), ''].join('\n');
}

/** Returns a line about all assets together, whose run took `seconds`; nothing if there are fewer than two. */
export function total(assets, seconds) {
  const done = assets.filter((asset) => !asset.error);
  if (assets.length < 2 || done.length === 0) return '';
  const failed = assets.length === done.length ? '' : ` and ${assets.length - done.length} failed`;
  const totals = done.map(totalsOf).reduce(sum);
  return `total of ${count(done.length, 'asset')}${failed}: ${text(totals, seconds)}\n`;
}

/** Returns what was baked, and its sizes. */
function totalsOf({ layers, textures, inputBytes, bytes, sizes }) {
  const materials = new Set(layers.filter((layer) => layer.model).map((layer) => layer.index)).size;
  return { materials, textures: textures.length, before: inputBytes, after: bytes, ...sizes };
}

/** Adds members of objects with the same members. */
export function sum(a, b) {
  return Object.fromEntries(Object.keys(a).map((name) => [name, a[name] + b[name]]));
}

/** Returns for example `5 materials, 8 textures, 7.2 -> 9.1 MB (KTX2 1.9, geometry 7.2), 0.81 s`. */
function text(totals, seconds) {
  const { materials, textures, before, after } = totals;
  const [divisor, unit] = Math.max(before, after) < 1e6 ? [1e3, 'kB'] : [1e6, 'MB'];
  const number = (bytes) => fixed(bytes / divisor, 1);
  const parts = Object.entries(PARTS)
    .map(([part, name]) => [name, number(totals[part])])
    .filter(([, bytes]) => bytes !== '0.0')
    .map(([name, bytes]) => `${name} ${bytes}`);
  return (
    `${bakedText(materials, textures)}, ${number(before)} -> ${number(after)} ${unit} ` +
    `(${parts.join(', ')}), ${fixed(seconds, 2)} s`
  );
}

/** Returns what was baked. The materials are those with baked bumps. */
function bakedText(materials, textures) {
  if (textures === 0) return 'no normal or height maps';
  const baked = count(textures, 'texture');
  return materials === 0 ? baked : `${count(materials, 'material')}, ${baked}`;
}

/**
 * Returns a number as Rust's `{:.digits$}` writes it: where a number lies exactly between two decimal numbers, it
 * becomes the even one. `toFixed` takes the larger one.
 */
export function fixed(value, digits) {
  // Exactly between two numbers of n digits are only odd multiples of 2^-(n+1), since a double is a binary fraction.
  const isTie = Math.abs((value * 2 ** (digits + 1)) % 2) === 1;
  if (!isTie) return value.toFixed(digits);
  const scale = 10 ** digits;
  return ((2 * Math.round((value * scale) / 2)) / scale).toFixed(digits);
}

/** Returns a line for each different note on assets that asks for something, with the materials that have the note. */
export function notesToActOn(assets) {
  const names = new Map();
  for (const { input, layers = [] } of assets) {
    for (const layer of layers) {
      const name = assets.length === 1 ? nameOf(layer) : `${input} (${nameOf(layer)})`;
      for (const note of layer.notes.filter((note) => note.asksForAction)) {
        names.set(note.text, [...(names.get(note.text) ?? []), name]);
      }
    }
  }
  const line = ([note, of]) => {
    const more = of.length > MAX_NAMED ? ` and ${of.length - MAX_NAMED} more` : '';
    return `  note: ${printable(of.slice(0, MAX_NAMED).join('; '))}${more}: ${printable(note)}\n`;
  };
  return [...names].map(line).join('');
}

function layerLines(layer) {
  const { model = 'no bumps', choice, finest, notes } = layer;
  const sampled = finest ? `, sampled from level ${finest.level} on, typically ${finest.typicalLevel}` : '';
  return [
    `  ${printable(nameOf(layer))}: ${model}${choice ? choiceText(choice) : ''}${sampled}`,
    ...notes.map((note) => `    note: ${printable(note.text)}`),
  ];
}

/** Returns the largest errors of the chosen candidate and of the other models. */
function choiceText({ candidates, chosen }) {
  const taken = candidates[chosen];
  if (!taken) return '';
  // Errors are numbers of 32 bits, which the report writes with few digits.
  const worst = ({ errors }) => fixed(Math.fround(Math.max(0, ...errors)), 2);
  const finest = Math.min(...candidates.map(({ first }) => first));
  // Other models are shown at full size only.
  const others = candidates.filter(({ model, first }) => model !== taken.model && first === finest).reverse();
  const shown = others.map((other) => `${other.model} ${worst(other)}`).join(', ');
  return `${FRACTIONS[taken.first - finest] ?? ''} (error ${worst(taken)}${shown && `; ${shown}`})`;
}

/** Returns the name of the material, and of the layer if it is not the base layer. */
function nameOf({ material, layer }) {
  return layer === 'base' ? material : `${material}, ${layer}`;
}

/** Returns text on one line, with characters that a terminal or a log acts on escaped as Rust writes them. */
export function printable(text) {
  return text.replace(ACTIVE, (character) => `\\u{${character.codePointAt(0).toString(16)}}`);
}
