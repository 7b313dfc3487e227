// The command line on WebAssembly: the commands `bake` and `map`.
import { createRequire } from 'node:module';
import { platformPackage } from '../binary.js';
import { bakeCommand } from './bake.js';
import { mapCommand } from './map.js';
import { UsageError } from './options.js';

const { version } = createRequire(import.meta.url)('../../package.json');

const HELP = `Bake lost bump roughness into KTX2 textures and glTF materials.

Usage:
  roughcast bake <INPUT>... -o <DIR|FILE.glb|FILE.gltf>   .gltf, .glb, or folders of them
  roughcast map <IMAGE> -o <OUT.ktx2>                     one normal or height map

Settings: --profile portable|pyramid|both, --model auto|none|isotropic|anisotropic, --engine NAME, --quality fast|best,
--max-error E, --rdo DB, --target basis|float, --gltf fallback|strict|dual, --glb, --frame, --height-scale, ...
They are those of the native tool, which has more commands and uses all processors. It is in the package
${platformPackage}, which is not installed: WebAssembly runs in its place.
`;

/** Commands that only the native tool has. */
const NATIVE = ['watch', 'check', 'inspect', 'compare', 'render', 'plan', 'init', 'view', 'completions', 'man'];

/**
 * Runs a command.
 *
 * @param {string[]} args
 * @param {{stdout: {write(text: string): void}, stderr: {write(text: string): void}}} streams
 * @returns {Promise<number>} the exit code: 0 done, 1 an input failed, 2 usage
 */
export async function run([command, ...args], { stdout, stderr }) {
  try {
    switch (command) {
      case 'bake':
        return await bakeCommand(args, stdout, stderr);
      case 'map':
        return await mapCommand(args, stdout, stderr);
      case '--version':
      case '-V':
        stdout.write(`roughcast ${version} (WebAssembly)\n`);
        return 0;
      case '--help':
      case '-h':
      case 'help':
        stdout.write(HELP);
        return 0;
      case undefined:
        stderr.write(HELP);
        return 2;
      default: {
        const why = NATIVE.includes(command)
          ? `${command} needs the native tool; install the package ${platformPackage}, or build the tool with cargo`
          : `expected bake or map, found ${command}; see roughcast --help`;
        stderr.write(`error: ${why}\n`);
        return 2;
      }
    }
  } catch (error) {
    stderr.write(`error: ${error.message}\n`);
    return error instanceof UsageError ? 2 : 1;
  }
}
