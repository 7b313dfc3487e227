// What Blender keeps of a baked asset.
import { execFile } from 'node:child_process';
import { existsSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { promisify } from 'node:util';
import { COLUMNS, compare } from './survival.js';
import { validity } from './tools.js';

const run = promisify(execFile);
const python = fileURLToPath(new URL('venv/bin/python', import.meta.url));
const script = fileURLToPath(new URL('blender.py', import.meta.url));

/** False, or the reason why the test of Blender cannot run. */
export const missing = !existsSync(python) && 'the test of Blender needs `bash tools/interop/install-blender`';

/** Returns the table of what Blender's importer and exporter keep. `baked` are the files of bakeForms. */
export async function blender(baked, folder) {
  const rows = [];
  for (const [form, source] of Object.entries(baked)) {
    const output = path.join(folder, `blender-${form}.glb`);
    // An import that fails exits with an error and writes nothing.
    await run(python, [script, source, output]).catch((error) => {
      if (existsSync(output) || !error.stderr.includes('RuntimeError')) throw error;
    });
    const cells = existsSync(output)
      ? [...compare(source, output), await validity(output)]
      : ['refused', ...Array(COLUMNS.length).fill('')];
    rows.push([`\`${form}\``, ...cells]);
  }
  const header = ['form', ...COLUMNS, 'after it'];
  const lines = rows.map((cells) => `| ${cells.join(' | ')} |`);
  return [`| ${header.join(' | ')} |`, `|${' --- |'.repeat(header.length)}`, ...lines].join('\n');
}
