// Runs Roughcast, the commands of other tools, and the validator of Khronos.
import { execFile } from 'node:child_process';
import { existsSync, readFileSync, statSync } from 'node:fs';
import path from 'node:path';
import process from 'node:process';
import { fileURLToPath } from 'node:url';
import { promisify } from 'node:util';
import { NATIVE_GLTFPACK, scripts } from './commands.js';

const run = promisify(execFile);
const folder = fileURLToPath(new URL('.', import.meta.url));

export const repository = fileURLToPath(new URL('../../', import.meta.url));

/** Path of the tool: $ROUGHCAST, which `cargo test` sets, else the newest that Cargo built here. */
export const tool =
  process.env.ROUGHCAST ??
  ['release', 'debug']
    .map((profile) => path.join(repository, 'target', profile, 'roughcast'))
    .filter(existsSync)
    .sort((a, b) => statSync(b).mtimeMs - statSync(a).mtimeMs)[0];

/** False, or the reason why the tests cannot run. */
export const missing = !tool
  ? 'these tests need `cargo build` first (or $ROUGHCAST)'
  : !scripts.every(existsSync) && 'these tests need `npm ci --prefix tools/interop`';

/** False, or the reason why the test of the native gltfpack cannot run. */
export const nativeMissing =
  !existsSync(NATIVE_GLTFPACK) && 'the test of the native gltfpack needs `bash benches/sizes/install`';

/** Runs Roughcast. */
export const roughcast = (...options) => run(tool, options);

/** Runs a command of commands.js on `input`. Rejects if it fails or writes no output. */
export async function execute(command, input, output) {
  // `ktx` in this folder stands in for that of KTX-Software, and finds Roughcast by its variable.
  const env = { ...process.env, PATH: `${folder}${path.delimiter}${process.env.PATH}`, ROUGHCAST: path.resolve(tool) };
  const [program, ...options] = command.argv(input, output);
  const { stdout, stderr } = await run(program, options, { env });
  if (!existsSync(output)) throw new Error(`${command.name}: no output\n${stdout}${stderr}`);
}

/**
 * Says whether a file is valid: "valid", or the codes of the errors that Khronos' validator and `roughcast check` find.
 * The validator does not know KHR_texture_basisu, whose rules `check` tests.
 */
export async function validity(file) {
  // Imported here, so that the tests can say what is missing.
  const { default: validator } = await import('gltf-validator');
  const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), {
    uri: path.basename(file),
    maxIssues: 0,
    externalResourceFunction: async (uri) =>
      new Uint8Array(readFileSync(path.join(path.dirname(file), decodeURIComponent(uri)))),
  });
  const errors = report.issues.messages.filter(({ severity }) => severity === 0).map(({ code }) => code);
  const codes = [...new Set([...errors, ...(await checkErrors(file))])].sort();
  return codes.length === 0 ? 'valid' : codes.join(', ');
}

/** Returns the codes of the errors of `roughcast check`, which exits with 3 where it finds one. */
async function checkErrors(file) {
  const { stdout } = await roughcast('check', file, '--format', 'json').catch((error) => {
    if (error.code === 3) return error;
    throw error;
  });
  return JSON.parse(stdout)
    .findings.filter(({ severity }) => severity === 'error')
    .map(({ code }) => code);
}
