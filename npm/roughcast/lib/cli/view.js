// `roughcast view`: the viewer, which Node serves whether or not the native tool is there.
import { existsSync } from 'node:fs';
import { readFile, stat } from 'node:fs/promises';
import path from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { parseArgs } from 'node:util';
import { stem } from '../names.js';
import { findAssets } from './files.js';
import { UsageError } from './options.js';
import { printable } from './summary.js';

const VIEWER = fileURLToPath(new URL('../../viewer', import.meta.url));

const HELP = `Show an asset, its bakes and a supersampled picture side by side, in a browser.

Usage: roughcast view [ASSET|FOLDER]... [--original ASSET] [--events < EVENTS]

  roughcast view                        an empty page: drop your files on it
  roughcast view model.glb baked.glb    the original and its bake
  roughcast view assets out             an asset of the folder assets, and its bake of the same name

  --original ASSET   the original, if its file does not show it to be one
  --events           reload when \`roughcast watch --json\`, on standard input, reports new outputs

The page is served on 127.0.0.1 until Ctrl-C. No file leaves the machine.
`;

/** Serves the viewer. Returns the exit code; the server keeps the process alive. */
export async function viewCommand(args, { stdin, stdout, stderr }) {
  const { positionals, values } = parsed(args);
  if (values.help) {
    stdout.write(HELP);
    return 0;
  }
  if (!existsSync(VIEWER)) {
    throw new Error(`expected the viewer at ${VIEWER}, found none; a checkout has npm run view --prefix plugins/three`);
  }
  const modules = await Promise.all(['show.js', 'page/variants.js', 'page/refusal.js'].map((name) => load(name)));
  const [{ show }, variants, { refusal }] = modules;
  const { files, others } = await choose(positionals, variants, refusal);
  if (values.original) files.original = path.resolve(values.original);
  const folders = { page: path.join(VIEWER, 'page'), three: path.join(VIEWER, 'three') };
  const url = await show(files, folders, { events: values.events && stdin });
  const shown = Object.entries(files).map(([variant, file]) => `  ${variants.TITLES[variant]}: ${file}\n`);
  stdout.write(`${url}\n${shown.join('')}`);
  if (others > 0) stderr.write(`note: the folders have ${others} more; name a file to see another asset\n`);
  return 0;
}

function parsed(args) {
  const flag = { type: 'boolean' };
  const options = { original: { type: 'string' }, events: flag, help: { ...flag, short: 'h' } };
  try {
    return parseArgs({ args, options, allowPositionals: true });
  } catch (error) {
    throw new UsageError(error.message);
  }
}

/** Returns a document of the asset of which there are the most; undefined if there are none. */
function mostVariants(documents) {
  const number = ({ file }) => documents.filter((other) => stem(other.file) === stem(file)).length;
  return documents.reduce((best, document) => (best && number(best) >= number(document) ? best : document), undefined);
}

const load = (name) => import(pathToFileURL(path.join(VIEWER, name)));

/**
 * Chooses the documents to show: those that are named, and from folders those of one asset, which have one name.
 *
 * @returns {Promise<{files: Record<string, string>, others: number}>} the documents by variant, and the number of
 * documents of other assets
 */
async function choose(inputs, { TITLES, readDocument, variantOf }, refusal) {
  const [named, found] = [[], []];
  for (const input of inputs) {
    const isFolder = (await stat(input).catch(() => undefined))?.isDirectory();
    const documents = await Promise.all((await findAssets(input)).map(({ file }) => described(path.resolve(file))));
    (isFolder ? found : named).push(...documents);
  }
  const shown = named[0] ?? mostVariants(found);
  const isShown = ({ file }) => stem(file) === stem(shown.file);
  const files = {};
  for (const { variant, file } of [...named, ...found.filter(isShown)]) {
    // A file that is named may lie in a folder that is named, too.
    if (files[variant] && files[variant] !== file) {
      const both = `${files[variant]} and ${file}, both “${TITLES[variant]}”`;
      throw new UsageError(`expected one file of each kind, found ${both}; name one of them`);
    }
    files[variant] = file;
  }
  return { files, others: found.filter((document) => !isShown(document)).length };

  /** Returns a document with the variant that it is. */
  async function described(file) {
    try {
      const bytes = await readFile(file);
      const reason = refusal(file, bytes);
      if (reason) throw new Error(reason);
      return { file, variant: variantOf(readDocument(bytes)) };
    } catch (error) {
      throw new Error(`${file}: cannot be shown: ${printable(error.message)}`, { cause: error });
    }
  }
}
