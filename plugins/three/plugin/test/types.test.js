import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import test from 'node:test';
import { fileURLToPath } from 'node:url';

test('the types compile', () => {
  const [project, compiler] = ['../types', '../../node_modules/typescript/bin/tsc'].map((name) =>
    fileURLToPath(new URL(name, import.meta.url)),
  );
  const { status, stdout, stderr } = spawnSync(process.execPath, [compiler, '--project', project], {
    encoding: 'utf8',
  });
  assert.equal(status, 0, stdout + stderr);
});
