// What the tests share.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import process from 'node:process';
import { fileURLToPath } from 'node:url';

export const npm = fileURLToPath(new URL('..', import.meta.url));
export const repository = path.dirname(npm.replace(/[/\\]$/, ''));
export const fixtures = path.join(repository, 'fixtures');

/** The tool: $ROUGHCAST, else what `cargo build --release` made, else what `cargo build` made. */
export const binary = [
  process.env.ROUGHCAST,
  ...['release', 'debug'].map((profile) =>
    path.join(process.env.CARGO_TARGET_DIR ?? path.join(repository, 'target'), profile, 'roughcast'),
  ),
].find((name) => name && existsSync(name));

/** Reasons to skip a test, or false. */
export const noBinary = binary ? false : 'needs the tool: cargo build --release, or $ROUGHCAST';
const modules = ['roughcast.wasm', 'roughcast.threads.wasm'].map((name) => path.join(npm, 'roughcast', name));
export const noModule = modules.every(existsSync) ? false : 'needs the WebAssembly modules: bash npm/wasm/build.sh';

/** Returns a temporary folder, which is removed after the test. */
export function temporary(t) {
  const folder = mkdtempSync(path.join(os.tmpdir(), 'roughcast-npm-'));
  t.after(() => rmSync(folder, { recursive: true, force: true }));
  return folder;
}

/** Runs a program. Returns its standard output. */
export function run(program, args, options = {}) {
  return execFileSync(program, args, { encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'], ...options });
}
