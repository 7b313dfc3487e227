// Other tools keep of baked assets what docs/interop.md says. MATRIX=overwrite writes the tables anew.
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import process from 'node:process';
import test from 'node:test';
import { blender, missing as blenderMissing } from '../blender.js';
import { NATIVE } from '../commands.js';
import { after, afterByForm, bakeForms, before } from '../matrix.js';
import { missing, nativeMissing, repository } from '../tools.js';

const PAGE = path.join(repository, 'docs/interop.md');

for (const reason of [missing, blenderMissing].filter(Boolean)) {
  if (process.env.CI === 'true') throw new Error(reason);
  console.log(`skipped: ${reason}`);
}
// CI does not build gltfpack.
if (nativeMissing) console.log(`skipped: ${nativeMissing}`);

function temporary(t) {
  const folder = mkdtempSync(path.join(os.tmpdir(), 'roughcast-interop-'));
  t.after(() => rmSync(folder, { recursive: true, force: true }));
  return folder;
}

/** Compares the table between the marks `name` of the page with `found`, or writes it there. */
function assertTable(name, found) {
  const place = new RegExp(`(<!-- ${name}: [^\\n]* -->\\n)[^]*?(\\n<!-- ${name} end -->)`);
  const page = readFileSync(PAGE, 'utf8');
  assert.match(page, place);
  if (process.env.MATRIX === 'overwrite')
    writeFileSync(
      PAGE,
      page.replace(place, (_, start, end) => start + found + end),
    );
  else assert.equal(page.match(place)[0].split('\n').slice(1, -1).join('\n'), found);
}

test('commands keep of a baked asset what the page says', { skip: missing }, async (t) => {
  const folder = temporary(t);
  assertTable('after', await after(await bakeForms(folder), folder));
});

test('a bake takes what commands write', { skip: missing }, async (t) => {
  assertTable('before', await before(temporary(t)));
});

test('Blender keeps of a baked asset what the page says', { skip: missing || blenderMissing }, async (t) => {
  const folder = temporary(t);
  assertTable('blender', await blender(await bakeForms(folder), folder));
});

test('native gltfpack compresses textures as the page says', { skip: missing || nativeMissing }, async (t) => {
  const folder = temporary(t);
  assertTable('native-after', await afterByForm(await bakeForms(folder), folder, NATIVE));
  assertTable('native-before', await before(folder, NATIVE));
});
