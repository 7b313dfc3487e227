// The bake by the native tool, in a temporary folder.
import { execFile } from 'node:child_process';
import { mkdir, mkdtemp, readFile, readdir, rm, writeFile } from 'node:fs/promises';
import os from 'node:os';
import path from 'node:path';
import { promisify } from 'node:util';
import { flags } from './settings.js';

const execute = promisify(execFile);

/** Returns the functions of a backend for the tool at `binary`. */
export function nativeBackend(binary) {
  return {
    bakeDocument: ({ input, beside, settings, threads = 0, onProgress }) =>
      inFolder(async (folder) => {
        const [source, output] = [path.join(folder, 'in'), path.join(folder, 'out')];
        await writeFiles(source, [input, ...beside]);
        const report = path.join(folder, 'report.json');
        const options = [...flags({ threads, ...settings }), '--no-config', '--quiet', '--report', report];
        await run(binary, ['bake', path.join(source, input.path), '-o', output, ...options], folder);
        onProgress?.(1);
        const { assets, ...runReport } = JSON.parse(await readFile(report));
        const { output: document, layers, textures } = assets[0];
        const files = await readFiles(output);
        const isDocument = (file) => file.path === path.basename(document);
        const copies = files.filter((file) => beside.some(({ path }) => path === file.path)).map(({ path }) => path);
        return {
          document: files.find(isDocument),
          files: files.filter((file) => !isDocument(file) && !copies.includes(file.path)),
          copies,
          runReport,
          report: { layers, textures },
        };
      }),

    bakeImage: ({ output, files, options, settings, threads = 0 }) =>
      inFolder(async (folder) => {
        const source = path.join(folder, 'in');
        await writeFiles(source, files);
        const [image, roughness] = files.map((file) => path.join(source, file.path));
        const target = path.join(folder, 'out', output);
        const { height, greenDown, ...values } = options;
        const switches = [height && '--height', greenDown && '--green-down'].filter(Boolean);
        if (roughness) switches.push('--roughness', roughness);
        const all = [...switches, ...flags(values), ...flags({ threads, ...settings }), '--json'];
        const report = JSON.parse(await run(binary, ['map', image, '-o', target, ...all], folder));
        const baked = [];
        for (const texture of report.textures) {
          baked.push({ path: path.basename(texture.path), bytes: new Uint8Array(await readFile(texture.path)) });
          texture.path = path.basename(texture.path);
        }
        return { files: baked, report };
      }),
  };
}

/** Runs the tool. Returns its standard output, or throws its message without the names of the temporary folder. */
async function run(binary, args, folder) {
  try {
    return (await execute(binary, args, { maxBuffer: 2 ** 28 })).stdout;
  } catch (error) {
    const message = String(error.stderr || error.message).replaceAll(path.join(folder, 'in') + path.sep, '');
    throw new Error(message.trim().replace(/^error: /, ''), { cause: error });
  }
}

/** Calls `work` with a temporary folder, and removes the folder. */
async function inFolder(work) {
  const folder = await mkdtemp(path.join(os.tmpdir(), 'roughcast-'));
  try {
    return await work(folder);
  } finally {
    await rm(folder, { recursive: true, force: true });
  }
}

async function writeFiles(folder, files) {
  for (const { path: name, bytes } of files) {
    const file = path.join(folder, name);
    if (path.relative(folder, file).startsWith('..')) {
      throw new Error(`${name}: expected a file beside the document, found one outside its folder; bake with the tool`);
    }
    await mkdir(path.dirname(file), { recursive: true });
    await writeFile(file, bytes);
  }
}

/** Reads all files below a folder, in the order of their names. */
async function readFiles(folder) {
  const entries = await readdir(folder, { recursive: true, withFileTypes: true });
  const names = entries.filter((entry) => entry.isFile()).map((entry) => path.join(entry.parentPath, entry.name));
  return Promise.all(
    names.sort().map(async (name) => ({
      path: path.relative(folder, name).replaceAll(path.sep, '/'),
      bytes: new Uint8Array(await readFile(name)),
    })),
  );
}
