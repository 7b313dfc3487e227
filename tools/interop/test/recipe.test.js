// The recipe at the top of docs/interop.md, run as it stands there.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import process from 'node:process';
import test from 'node:test';
import { read } from '../asset.js';
import { scripts } from '../commands.js';
import { missing, repository, roughcast, tool, validity } from '../tools.js';

/** Shell functions with the names that the recipe has. */
const COMMANDS = `
gltf-transform() { '${process.execPath}' '${scripts[0]}' "$@"; }
roughcast() { '${tool}' "$@"; }
`;

test('the recipe of the page makes a small and valid file', { skip: missing }, async (t) => {
  const folder = mkdtempSync(path.join(os.tmpdir(), 'roughcast-recipe-'));
  t.after(() => rmSync(folder, { recursive: true, force: true }));
  const page = readFileSync(path.join(repository, 'docs/interop.md'), 'utf8');
  const [, recipe] = page.match(/```sh\n([^]*?)```/);
  const script = `set -euo pipefail${COMMANDS}gltf-transform copy "$1" source.glb\n${recipe}`;
  const source = path.join(repository, 'fixtures/brushed/brushed.gltf');
  execFileSync('bash', ['-c', script, 'bash', source], { cwd: folder, stdio: 'pipe' });
  const baked = path.join(folder, 'baked.glb');
  assert.equal(await validity(baked), 'valid');
  const types = read(baked).json.images.map((image) => image.mimeType);
  assert.deepEqual(types.sort(), ['image/ktx2', 'image/ktx2', 'image/ktx2', 'image/webp']);
  await roughcast('check', baked);
});
