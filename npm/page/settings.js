// The options of the bake that a person can choose.
import { flags } from './roughcast/lib/settings.js';

/** Returns the settings of the library for the values of the form. Empty values are those that the library chooses. */
export function settingsOf(form) {
  const { engine, textures, maxSize, quality, rdo } = Object.fromEntries(new FormData(form));
  return {
    quality,
    textures,
    ...(engine && { engine }),
    ...(maxSize && { maxSize: Number(maxSize) }),
    ...(rdo && { rdo: Number(rdo) }),
  };
}

/** Returns the name of the baked file, which says what differs from the first settings of the page. */
export function nameOf(name, { engine = 'any', textures, maxSize, quality, rdo }) {
  const marks = [
    engine !== 'three' && engine,
    textures !== 'bumps' && textures,
    maxSize,
    quality !== 'fast' && quality,
    rdo && `rdo${rdo}`,
  ];
  return [name, 'baked', ...marks.filter(Boolean)].join('-') + '.glb';
}

/** Settings of the page that the command line has without a flag. */
const DEFAULTS = { quality: 'fast', textures: 'bumps' };

/** Returns the command that makes the file which the page offers. */
export function commandOf(name, settings) {
  const chosen = Object.entries(settings).filter(([key, value]) => DEFAULTS[key] !== value);
  const options = flags(Object.fromEntries(chosen)).map((flag) => flag.replace('=', ' '));
  const [input, output] = [`${name}.glb`, nameOf(name, settings)].map(quoted);
  return ['npx roughcast bake', input, '-o', output, ...options].join(' ');
}

/** Returns a file name as a word of a shell. */
function quoted(text) {
  return /^[\w.-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`;
}
