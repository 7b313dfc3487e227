// Options of the command line.
import { parseArgs } from 'node:util';
import { DOCUMENT_SETTINGS, MAP_SETTINGS, kebab } from '../settings.js';

/** Arguments that cannot be used. */
export class UsageError extends Error {}

const text = { type: 'string' };
const flag = { type: 'boolean' };

/** Settings that `bake` and `map` share. */
const TEXTURE = { ...optionsOf(MAP_SETTINGS.filter((name) => name !== 'provenance')), 'no-provenance': flag };

/** Settings of `bake` only. */
export const DOCUMENT = optionsOf(DOCUMENT_SETTINGS);

/** Where outputs go, with how many threads, and what is printed. */
export const OUTPUT = {
  output: { type: 'string', short: 'o' },
  json: flag,
  threads: text,
  quiet: { type: 'boolean', short: 'q' },
  verbose: { type: 'boolean', short: 'v' },
};

const NUMBERS = [
  'max-error',
  'rdo',
  'max-size',
  'max-texels',
  'height-scale',
  'nearest',
  'screen-height',
  'fov',
  'aspect',
];

/** Options that may stand without a value, which is then true. */
const SWITCHES = ['glb', 'scale-normals', 'trim'];

/**
 * Reads arguments.
 *
 * @param {string[]} args
 * @param {object} own options of the command, besides those that `bake` and `map` share
 * @returns {{inputs: string[], settings: object, values: object}} settings under the names of roughcast.toml; `values`
 * are the options that `own` and `OUTPUT` declare
 */
export function parse(args, own) {
  let parsed;
  const isBare = (arg) => SWITCHES.some((name) => arg === `--${name}`);
  const complete = args.map((arg) => (isBare(arg) ? `${arg}=true` : arg));
  try {
    parsed = parseArgs({ args: complete, options: { ...TEXTURE, ...OUTPUT, ...own }, allowPositionals: true });
  } catch (error) {
    throw new UsageError(`${error.message} If the native tool has this option, install its package.`);
  }
  const { positionals, values } = parsed;
  if (positionals.length === 0) throw new UsageError('expected an input, found none; name one');
  if (values.output === undefined) throw new UsageError('expected an output, found none; name one with -o');
  const { 'no-provenance': withoutProvenance, ...settings } = pick(values, { ...TEXTURE, ...DOCUMENT });
  if (withoutProvenance) settings.provenance = false;
  if (settings['main-direction']) settings['main-direction'] = settings['main-direction'].split(',').map(Number);
  for (const name of NUMBERS.filter((name) => name in settings)) settings[name] = number(name, settings[name]);
  for (const name of SWITCHES.filter((name) => name in settings)) settings[name] = truth(name, settings[name]);
  if (values.threads) values.threads = number('threads', values.threads);
  return { inputs: positionals, settings, values };
}

/** Returns the value of an option as a number. */
export function number(name, value) {
  const parsed = Number(value);
  if (value.trim() !== '' && Number.isFinite(parsed)) return parsed;
  throw new UsageError(`--${name}: expected a number, found ${value}`);
}

/** Returns the value of a switch as a boolean. */
function truth(name, value) {
  if (value === 'true' || value === 'false') return value === 'true';
  throw new UsageError(`--${name}: expected true or false, found ${value}`);
}

/** Returns an option with a value for each setting. */
function optionsOf(settings) {
  return Object.fromEntries(settings.map((name) => [kebab(name), text]));
}

function pick(values, names) {
  return Object.fromEntries(Object.entries(values).filter(([name]) => name in names));
}
