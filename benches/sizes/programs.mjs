// Finds and runs the programs of the comparison: those that `install` builds, else those of the user's PATH.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { delimiter, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const BUILT = fileURLToPath(new URL('../../target/sizes/bin', import.meta.url));
process.env.PATH = `${BUILT}${delimiter}${process.env.PATH}`;

/** Runs a program, and throws what it says on its standard error if it fails. */
export const run = (program, ...options) =>
  execFileSync(program, options.map(String), { stdio: ['ignore', 'ignore', 'pipe'] });

/** Runs `work` with the path of a new folder, which is removed afterwards. */
export async function inFolder(work) {
  const folder = mkdtempSync(join(tmpdir(), 'sizes-'));
  try {
    return await work(folder);
  } finally {
    rmSync(folder, { recursive: true });
  }
}

/** Runs gltfpack on an asset that has an image: without Basis Universal it refuses to compress any image. */
function probeGltfpack(folder) {
  const asset = join(folder, 'probe.gltf');
  writeFileSync(asset, '{"asset": {"version": "2.0"}, "images": [{"uri": "missing.png"}]}');
  run('gltfpack', '-tc', '-i', asset, '-o', join(folder, 'out.glb'));
}

/** Tests of the programs, which throw if a program is missing or cannot do what the recipes need. */
const PROBES = {
  gltfpack: probeGltfpack,
  basisu: () => run('basisu', '-version'),
  ktx: () => run('ktx', '--version'),
};

/** Returns the names of the programs whose rows cannot be measured. */
export const missingPrograms = () =>
  inFolder((folder) => Object.keys(PROBES).filter((program) => !succeeds(() => PROBES[program](folder))));

function succeeds(work) {
  try {
    work();
    return true;
  } catch {
    return false;
  }
}
