// The command line without the native tool: `bake` and `map` on WebAssembly, and the viewer.
import { createRequire } from 'node:module';
import { findBinary } from '../binary.js';
import { bakeCommand } from './bake.js';
import { mapCommand } from './map.js';
import { UsageError } from './options.js';
import { viewCommand } from './view.js';

const { version } = createRequire(import.meta.url)('../../package.json');

/** Returns the help. */
const help = () => `Bake lost bump roughness into KTX2 textures and glTF materials.

Usage:
  roughcast bake <INPUT>... -o <DIR|FILE.glb|FILE.gltf>   .gltf, .glb, or folders of them
  roughcast map <IMAGE> -o <OUT.ktx2>                     one normal or height map
  roughcast view [ASSET|FOLDER]...                        assets and bakes in a browser

Settings: --profile portable|pyramid|both, --model auto|none|isotropic|anisotropic, --engine NAME, --quality fast|best,
--max-error E, --rdo DB, --target basis|float, --gltf strict|fallback|dual, --glb, --textures bumps|all, --max-size N,
--frame, --height-scale, ...
--threads N (default: one for each processor, at most 16)
They are those of the native tool, which has more commands and is faster.

WebAssembly runs in its place: ${whyWebAssembly()}.
`;

/** Returns why the native tool does not run, and what to do about it. */
function whyWebAssembly() {
  const { path, why } = findBinary();
  return path ? `ROUGHCAST_BACKEND is wasm; unset it to run ${path}` : why;
}

/** Commands that only the native tool has. */
const NATIVE = ['watch', 'check', 'inspect', 'compare', 'render', 'plan', 'init', 'completions', 'man'];

/**
 * Runs a command.
 *
 * @param {string[]} args
 * @param {{stdin: object, stdout: {write(text: string): void}, stderr: {write(text: string): void}}} streams
 * @returns {Promise<number>} the exit code: 0 done, 1 an input failed, 2 usage
 */
export async function run([command, ...args], { stdin, stdout, stderr }) {
  try {
    const asksForHelp = ['bake', 'map'].includes(command) && args.some((arg) => arg === '--help' || arg === '-h');
    switch (asksForHelp ? 'help' : command) {
      case 'bake':
        return await bakeCommand(args, stdout, stderr);
      case 'map':
        return await mapCommand(args, stdout, stderr);
      case 'view':
        return await viewCommand(args, { stdin, stdout, stderr });
      case '--version':
      case '-V':
        stdout.write(`roughcast ${version} (WebAssembly)\n`);
        return 0;
      case '--help':
      case '-h':
      case 'help':
        stdout.write(help());
        return 0;
      case undefined:
        stderr.write(help());
        return 2;
      default: {
        const why = NATIVE.includes(command)
          ? `${command}: expected the native tool, found WebAssembly: ${whyWebAssembly()}`
          : `expected bake, map or view, found ${command}; see roughcast --help`;
        stderr.write(`error: ${why}\n`);
        return 2;
      }
    }
  } catch (error) {
    stderr.write(`error: ${error.message}\n`);
    return error instanceof UsageError ? 2 : 1;
  }
}
