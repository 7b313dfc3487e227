// Engines use the levels that were baked, and docs/engines.md says which do. MATRIX=overwrite writes the table anew.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { missing as browserMissing } from '../browser.js';
import { run, table } from '../engines/matrix.js';
import { match, regenerated } from './levels.js';
import { missing, repository, temporary } from './roughcast.js';

const PAGE = path.join(repository, 'docs/engines.md');
const PLACE = /(<!-- engines: [^\n]* -->\n)[^]*?(\n<!-- engines end -->)/;

test('the matrix in docs/engines.md is what the engines do', { skip: missing || browserMissing }, async (t) => {
  const found = table(await run(temporary(t)));
  const page = readFileSync(PAGE, 'utf8');
  assert.match(page, PLACE);
  if (process.env.MATRIX === 'overwrite')
    writeFileSync(
      PAGE,
      page.replace(PLACE, (_, start, end) => start + found + end),
    );
  else assert.equal(page.match(PLACE)[0].split('\n').slice(1, -1).join('\n'), found);
});

/** Makes a level of one channel. */
const level = (width, height, data) => ({ width, height, channels: 1, data });
const uploaded = (levels) => ({
  width: levels[0].width,
  height: levels[0].height,
  levels: levels.map(({ data }) => [...data].flatMap((value) => [value, 0, 0, 255])),
});

test('tells generated levels from baked ones', () => {
  const level0 = level(2, 2, [0, 100, 100, 200]);
  const baked = [level0, level(1, 1, [180])];
  assert.deepEqual(regenerated(level0)[1].data, Float64Array.of(100));
  assert.deepEqual(match([uploaded(baked)], baked).ours, 0);
  assert.equal(match([uploaded(baked)], baked).theirs, 80);
  assert.equal(match([uploaded(regenerated(level0))], baked).ours, 80);
  assert.equal(match([uploaded([level(4, 4, Array(16).fill(0))])], baked), null);
});
