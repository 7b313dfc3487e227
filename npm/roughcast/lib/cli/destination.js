// Where outputs go: into a folder, or to a document that `-o` names. The native tool has the same in
// `crates/pipeline/src/project/destination.rs`.
import { stat } from 'node:fs/promises';
import path from 'node:path';
import { UsageError } from './options.js';

/** Extensions of files that a bake cannot write as its document. No one names a new folder so. */
const OTHER_FILES = ['.bin', '.fbx', '.jpeg', '.jpg', '.json', '.ktx2', '.obj', '.png', '.usdz', '.zip'];

/**
 * Returns what `-o output` means for `inputs`: a folder, and the name without extension of a document in it if `output`
 * ends in .gltf or .glb. The setting `glb` follows that extension.
 */
export async function destination(output, inputs, settings) {
  const refused = (text) => new UsageError(`-o ${output}: expected ${text}`);
  const extension = path.extname(output).toLowerCase();
  if (!['.glb', '.gltf'].includes(extension)) {
    if (!OTHER_FILES.includes(extension) || (await isFolder(output))) return { folder: output };
    const remedy = 'name a folder, or end the name in .gltf or .glb';
    throw refused(`a folder, or a file that ends in .gltf or .glb, found the name of another file; ${remedy}`);
  }
  if (inputs.length > 1 || (await isFolder(inputs[0]))) {
    const many = inputs.length > 1 ? `${inputs.length} inputs` : `the folder ${inputs[0]}`;
    const remedy = 'name one file as the input, or a folder with -o';
    throw refused(`one .gltf or .glb file as the input, since -o names one file, found ${many}; ${remedy}`);
  }
  if (await isFolder(output)) {
    throw refused('the name of a file, found a folder; choose another name, or remove the folder');
  }
  if (path.extname(output) !== extension) {
    const better = output.replace(/\.[^.]*$/, extension);
    throw refused(`a name in UTF-8 with its extension in lower case, found another one; name it ${better}`);
  }
  const glb = extension === '.glb';
  if ('glb' in settings && settings.glb !== glb) {
    const found = `--glb=${settings.glb}, found another extension; leave --glb out or name another document`;
    throw new UsageError(`${output}: expected a name that suits ${found}`);
  }
  settings.glb = glb;
  return { folder: path.dirname(output), name: path.parse(output).name };
}

/** Returns whether there is a folder at a path. */
const isFolder = async (place) => Boolean((await stat(place).catch(() => undefined))?.isDirectory());
