import path from 'node:path';
import process from 'node:process';
import test from 'node:test';
import { npm, run } from './common.js';

test('the types compile', () => {
  run(process.execPath, [path.join(npm, 'node_modules/typescript/bin/tsc'), '--project', path.join(npm, 'types')]);
});
