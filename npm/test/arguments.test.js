// What the library and its command line say of wrong arguments, and of the tool that runs.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import path from 'node:path';
import process from 'node:process';
import test from 'node:test';
import { bake, bakeMap } from 'roughcast';
import { DOCUMENT_SETTINGS, MAP_SETTINGS, kebab } from '../roughcast/lib/settings.js';
import { binary, fixtures, noBinary, noModule, npm, repository, run } from './common.js';

const options = { skip: noBinary || noModule };
process.env.ROUGHCAST_BINARY = binary ?? '';

test('the settings are those of roughcast.toml and of the flags', { skip: noBinary }, () => {
  const schema = JSON.parse(readFileSync(path.join(repository, 'schemas/roughcast.schema.json')));
  const names = [...MAP_SETTINGS, ...DOCUMENT_SETTINGS].map(kebab);
  assert.deepEqual(names.sort(), Object.keys(schema.$defs.settings.properties).sort());
  const help = run(binary, ['map', '--help']);
  for (const name of MAP_SETTINGS) assert.match(help, new RegExp(`--(no-)?${kebab(name)}\\b`));
});

test('both backends say the same of wrong arguments', options, async () => {
  const glb = readFileSync(path.join(fixtures, 'waves/waves.glb'));
  for (const backend of ['native', 'wasm']) {
    await assert.rejects(bake('foo.glb', { backend }), /^TypeError: document: .*, found String; read the file/);
    await assert.rejects(bake(undefined, { backend }), /^TypeError: document: .* found undefined;/);
    await assert.rejects(bakeMap(new ArrayBuffer(4), { backend }), /^TypeError: image: .* found ArrayBuffer;/);
    const misspelt = bake(glb, { backend, settings: { maxEror: 0.1 } });
    await assert.rejects(misspelt, /^TypeError: settings: expected names among profile, .*maxError.* found maxEror;/);
    const ofDocuments = bakeMap(glb, { backend, settings: { engine: 'three' } });
    await assert.rejects(ofDocuments, /^TypeError: settings: expected names among profile, .* found engine;/);
  }
});

test('the help says why WebAssembly runs', () => {
  const printed = (command, env) => {
    const tool = path.join(npm, 'roughcast/bin/roughcast.js');
    const { stdout, stderr } = spawnSync(process.execPath, [tool, command], {
      env: { ...process.env, ROUGHCAST_BACKEND: 'wasm', ...env },
      encoding: 'utf8',
    });
    return stdout + stderr;
  };
  const here = { ROUGHCAST_BINARY: process.execPath };
  assert.match(printed('--help', here), /in its place: ROUGHCAST_BACKEND is wasm; unset it to run /);
  assert.match(printed('check', here), /check: expected the native tool, .*: ROUGHCAST_BACKEND is wasm;/);
  assert.match(printed('--help', { ROUGHCAST_BINARY: '/nowhere' }), /ROUGHCAST_BINARY is \/nowhere, where no file is;/);
  assert.match(printed('--help', { ROUGHCAST_BINARY: '' }), /the package @roughcast\/\S+ is not installed; install it/);
});
