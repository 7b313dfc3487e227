// The packed packages, installed in an empty folder, as a newcomer has them.
import { cpSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import process from 'node:process';
import { after, before } from 'node:test';
import { binary, fixtures, noBinary, noModule, npm, run, temporary } from './common.js';

/** Packing needs the tool and the modules. */
export const options = { skip: noBinary || noModule };

/** Paths of the packages `platform` and `main`, which are packed before the tests of a file. */
export const packages = {};

let packed;
before(() => {
  if (options.skip) return;
  packed = mkdtempSync(path.join(os.tmpdir(), 'roughcast-packed-'));
  const made = run(process.execPath, [path.join(npm, 'make-packages.js'), '--binary', binary, '--out', packed]);
  [packages.platform, packages.main] = made.trim().split('\n');
});
after(() => packed && rmSync(packed, { recursive: true, force: true }));

/** Makes a folder with a GLB and installs packages in it, without a network. */
export function project(t, installed) {
  const folder = temporary(t);
  cpSync(path.join(fixtures, 'waves/waves.glb'), path.join(folder, 'model.glb'));
  writeFileSync(path.join(folder, 'package.json'), '{ "private": true, "type": "module" }');
  run('npm', ['install', '--offline', '--omit=optional', '--no-audit', '--no-fund', ...installed], { cwd: folder });
  return folder;
}

/** The environment of a user: nothing that names the repository's tool. */
const { ROUGHCAST, ROUGHCAST_BINARY, ROUGHCAST_BACKEND, ...environment } = process.env;
export { environment };

/** Runs the tool of a folder. Returns its standard output. */
export const npx = (folder, ...args) =>
  run('npx', ['--offline', 'roughcast', ...args], { cwd: folder, env: environment });
