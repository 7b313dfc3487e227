// The commands of other tools that the tables of docs/interop.md are about.
import path from 'node:path';
import process from 'node:process';
import { fileURLToPath } from 'node:url';

const folder = fileURLToPath(new URL('.', import.meta.url));
const script = (file) => path.join(folder, 'node_modules', file);
const GLTF_TRANSFORM = script('@gltf-transform/cli/bin/cli.js');
const GLTFPACK = script('gltfpack/cli.js');

/** The scripts that `npm ci` installs. */
export const scripts = [GLTF_TRANSFORM, GLTFPACK];

/** The native gltfpack that `benches/sizes/install` builds. Only this one can compress textures. */
export const NATIVE_GLTFPACK = path.join(folder, '../../target/sizes/bin/gltfpack');

/**
 * A command: its name in the tables, and what is run for an input and an output: a program and its arguments.
 *
 * @typedef {{name: string, argv: (input: string, output: string) => string[]}} Command
 */

/** Makes a command of glTF-Transform. */
const transform = (line) => {
  const [command, ...options] = line.split(' ');
  return {
    name: `gltf-transform ${line}`,
    argv: (input, output) => [process.execPath, GLTF_TRANSFORM, command, input, output, ...options],
  };
};

/** Makes commands of gltfpack, which `program` starts. */
const pack =
  (...program) =>
  (line) => ({
    name: `gltfpack ${line}`.trim(),
    argv: (input, output) => [...program, '-i', input, '-o', output, ...line.split(' ').filter(Boolean)],
  });

const nodePack = pack(process.execPath, GLTFPACK);

/**
 * Commands that are run on a baked asset. The commands of glTF-Transform that write no asset (`inspect`, `validate`,
 * `gzip`), that need several (`merge`, `sequence`), or that replace the material model (`metalrough`, `unlit`) are not
 * among them.
 *
 * @type {Command[]}
 */
export const AFTER = [
  ...[
    'copy',
    'dedup',
    'prune',
    'center',
    'flatten',
    'join',
    'instance',
    'palette',
    'resample',
    'sparse',
    'weld',
    'unweld',
    'reorder',
    'tangents',
    'simplify',
    'quantize',
    'dequantize',
    'draco',
    'meshopt',
    'resize --width 64 --height 64',
    'png',
    'jpeg',
    'webp',
    'avif',
    'uastc',
    'etc1s',
    'ktxfix',
    'ktxdecompress',
    'optimize',
    'optimize --compress draco --texture-compress webp',
    'optimize --texture-compress ktx2',
  ].map(transform),
  ...['', '-noq', '-c', '-cc -kn -km -ke -kv'].map(nodePack),
];

/**
 * Commands that are run before the bake.
 *
 * @type {Command[]}
 */
export const BEFORE = [
  ...[
    'copy',
    'quantize',
    'draco',
    'meshopt',
    'webp',
    'avif',
    'uastc',
    'etc1s',
    'optimize',
    'optimize --compress draco --texture-compress webp',
    'optimize --texture-compress ktx2',
  ].map(transform),
  ...['', '-c'].map(nodePack),
];

/**
 * Commands of the native gltfpack that compress textures, which are run before the bake and after it.
 *
 * @type {Command[]}
 */
export const NATIVE = ['-tc', '-tu'].map(pack(NATIVE_GLTFPACK));
