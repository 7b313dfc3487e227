// Runs the commands on baked assets, and before a bake, and writes what it finds as tables.
import { mkdirSync, readFileSync } from 'node:fs';
import path from 'node:path';
import { PYRAMID, read } from './asset.js';
import { AFTER, BEFORE } from './commands.js';
import { COLUMNS, compare } from './survival.js';
import { execute, repository, roughcast, validity } from './tools.js';

const FIXTURE = path.join(repository, 'fixtures/brushed/brushed.gltf');
const FORMS = ['strict', 'fallback', 'dual'];

/** The model is fixed, so that the tables do not depend on the choice among models. */
const OPTIONS = ['--profile', 'both', '--model', 'anisotropic', '--quiet'];

/** Bakes the fixture with tangents and anisotropy in each form. Returns the path of each. */
export async function bakeForms(folder) {
  const baked = {};
  for (const form of FORMS) {
    const output = path.join(folder, form);
    await roughcast('bake', FIXTURE, '-o', output, '--gltf', form, ...OPTIONS);
    baked[form] = path.join(output, 'brushed.gltf');
  }
  return baked;
}

/** Returns the table of what commands keep of a baked asset. `baked` are the files of bakeForms. */
export async function after(baked, folder, commands = AFTER) {
  const rows = await each(commands, async (command, index) => {
    const outputs = {};
    for (const form of FORMS) {
      mkdirSync(path.join(folder, `${index}`, form), { recursive: true });
      outputs[form] = path.join(folder, `${index}`, form, 'out.glb');
      await execute(command, baked[form], outputs[form]);
    }
    const valid = await Promise.all(FORMS.map((form) => validity(outputs[form])));
    return [...compare(baked.strict, outputs.strict), ...valid];
  });
  return table(['command', ...COLUMNS, ...FORMS.map((form) => `after \`${form}\``)], commands, rows);
}

/** Returns the table of what commands keep of each form. `baked` are the files of bakeForms. */
export async function afterByForm(baked, folder, commands) {
  const runs = commands.flatMap((command) => FORMS.map((form) => ({ ...command, form })));
  const rows = await each(runs, async ({ form, ...command }, index) => {
    const output = path.join(folder, `${index}.glb`);
    await execute(command, baked[form], output);
    return [`\`${form}\``, ...compare(baked[form], output), await validity(output)];
  });
  return table(['command', 'form', ...COLUMNS, 'after it'], runs, rows);
}

/** Options of a bake for which it reads meshes: a view needs densities, and a frame tangents. */
const NEEDS_MESHES = ['--nearest', '1', '--screen-height', '1080', '--frame', 'natural'];

/** Returns the table of bakes of what commands write. */
export async function before(folder, commands = BEFORE) {
  const rows = await each(commands, async (command, index) => {
    const [source, report] = ['glb', 'json'].map((extension) => path.join(folder, `before${index}.${extension}`));
    await execute(command, FIXTURE, source);
    const options = ['-o', path.join(folder, `before${index}`), '--report', report, '--gltf', 'strict', ...OPTIONS];
    try {
      await roughcast('bake', source, ...options, ...NEEDS_MESHES);
    } catch (error) {
      if (error.code !== 1) throw error;
      return ['refused', '', '', ''];
    }
    const [{ layers, output }] = JSON.parse(readFileSync(report, 'utf8')).assets;
    const { json } = read(output);
    const { frame } = json.materials[layers[0].index].extensions[PYRAMID];
    const wasRead = layers[0].finest !== undefined && frame === 'natural';
    const notes = layers[0].notes.map(({ kind }) => kind).filter((kind) => kind === 'compressedMesh');
    return ['baked', wasRead ? 'read' : 'not read', [...new Set(notes)].join(', ') || 'none', await validity(output)];
  });
  return table(['command', 'bake', 'meshes', 'note', 'after the bake'], commands, rows);
}

/** Calls `work` for each command, two at a time, since most of a command's time is that of starting it. */
async function each(commands, work) {
  const [results, queue] = [[], commands.entries()];
  const worker = async () => {
    for (const [index, command] of queue) results[index] = await work(command, index);
  };
  await Promise.all([worker(), worker()]);
  return results;
}

/** Writes a table in Markdown. Commands with equal cells share a row. */
function table(header, commands, rows) {
  const groups = new Map();
  for (const [index, cells] of rows.entries()) {
    const key = cells.join(' | ');
    groups.set(key, [...(groups.get(key) ?? []), commands[index].name]);
  }
  const lines = [...groups].map(([key, names]) => `| ${list(names)} | ${key} |`);
  return [`| ${header.join(' | ')} |`, `|${' --- |'.repeat(header.length)}`, ...lines].join('\n');
}

/** Lists names of commands, with the name of a tool once for all its commands. */
function list(names) {
  const tools = new Map();
  for (const name of names) {
    const [tool, ...rest] = name.split(' ');
    tools.set(tool, [...(tools.get(tool) ?? []), rest.length > 0 ? `\`${rest.join(' ')}\`` : 'without options']);
  }
  return [...tools].map(([tool, commands]) => `\`${tool}\`: ${commands.join(', ')}`).join('; ');
}
