// The tool, and what it writes.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, readdirSync, rmSync, statSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { decodePng } from './png.js';

export const repository = fileURLToPath(new URL('../../../', import.meta.url));
export const example = fileURLToPath(new URL('../', import.meta.url));

/** Path of the tool: $ROUGHCAST, which `cargo test` sets, else the newest that Cargo built here. */
const tool =
  process.env.ROUGHCAST ??
  ['release', 'debug']
    .map((profile) => path.join(repository, 'target', profile, 'roughcast'))
    .filter(existsSync)
    .sort((a, b) => statSync(b).mtimeMs - statSync(a).mtimeMs)[0];

/** False, or the reason why there is no tool. */
export const missing = tool ? false : 'these tests need `cargo build` first (or $ROUGHCAST)';

export function roughcast(...options) {
  return execFileSync(tool, options, { encoding: 'utf8', stdio: ['ignore', 'pipe', 'inherit'] });
}

/** Makes a folder that is deleted after the tests. */
export function temporary(t) {
  const folder = mkdtempSync(path.join(os.tmpdir(), 'roughcast-three-'));
  t.after(() => rmSync(folder, { recursive: true, force: true }));
  return folder;
}

/**
 * Returns the levels of every KTX2 file that a baked glTF names, by file, as `inspect` decodes them with another
 * transcoder.
 */
export function levels(gltf, folder) {
  roughcast('inspect', gltf, '--extract', folder);
  const files = new Map();
  for (const name of readdirSync(folder).sort()) {
    const [, file, level] = name.match(/^(.*)\.level(\d+)\.png$/) ?? [];
    if (file === undefined) continue;
    if (!files.has(file)) files.set(file, []);
    files.get(file)[Number(level)] = decodePng(readFileSync(path.join(folder, name)));
  }
  return files;
}
