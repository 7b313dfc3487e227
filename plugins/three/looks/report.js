// usage: npm run looks [-- <folder for pictures>]
// Prints the tables of docs/engines.md on distances, flicker and cost.
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { DISTANCES, KINDS, NAMES, costs, forEach, materials } from './run.js';

const VIEW = { size: 128, samples: 256 };
const SEQUENCE = { size: 96, samples: 64, frames: 12, distance: 12 };

const [pictures] = process.argv.slice(2);
if (pictures) mkdirSync(pictures, { recursive: true });
const folder = mkdtempSync(path.join(os.tmpdir(), 'roughcast-looks-'));
const row = (cells) => console.log(`| ${cells.join(' | ')} |`);
const flickers = [];
try {
  row(['material', 'subject', 'variant', ...DISTANCES, 'mean', 'closer']);
  row(Array(5 + DISTANCES.length).fill('---'));
  await forEach(folder, materials(folder), async (name, page) => {
    for (const kind of KINDS) {
      const errors = [];
      for (const distance of DISTANCES)
        errors.push(await page.evaluate((o) => window.errors(o), { ...VIEW, kind, distance }));
      const mean = (i, which) => errors.reduce((sum, variants) => sum + variants[i][which], 0) / errors.length;
      for (const [i, variant] of NAMES.entries()) {
        const cells = errors.map((variants) => variants[i].map((e) => e.toFixed(2)).join(' / '));
        const means = [0, 1].map((which) => mean(i, which).toFixed(2)).join(' / ');
        row([name, kind, variant, ...cells, means, i === 0 ? '' : `${(mean(0, 0) / mean(i, 0)).toFixed(1)}x`]);
      }
      flickers.push([
        name,
        kind,
        ...(await page.evaluate((o) => window.flicker(o), { ...SEQUENCE, kind })).map((f) => (1e6 * f).toFixed(1)),
      ]);
      if (!pictures) continue;
      for (const distance of DISTANCES) {
        const url = await page.evaluate((o) => window.sheet(o), { kind, distance, size: 256, samples: VIEW.samples });
        writeFileSync(path.join(pictures, `${name}-${kind}-${distance}.png`), Buffer.from(url.split(',')[1], 'base64'));
      }
    }
  });
  console.log();
  row(['material', 'subject', ...NAMES]);
  row(Array(2 + NAMES.length).fill('---'));
  flickers.forEach(row);
  console.log();
  row(['shading', 'operations', 'fetches']);
  row(Array(3).fill('---'));
  (await costs()).forEach(row);
} finally {
  rmSync(folder, { recursive: true, force: true });
}
