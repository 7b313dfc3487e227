// What is wrong with files that are no glTF documents, for a person. The native tool has the same words.

/** Extensions of scene formats from which other tools export glTF. */
const SCENES = /\.(3ds|abc|blend|c4d|dae|fbx|ma|max|mb|obj|ply|stl|usd|usda|usdc|usdz)$/i;

/** Number of bytes by which files are recognised. */
const ENOUGH = 1024;

/** Returns whether a name is that of a scene in another format than glTF. */
export const isOtherScene = (name) => SCENES.test(name);

/**
 * Returns why a file is refused, or nothing if it looks like a .glb or JSON document. Bytes are never quoted.
 *
 * @param {string} name of the file
 * @param {Uint8Array} bytes its first bytes, or all
 * @returns {string | undefined}
 */
export function refusal(name, bytes) {
  // The decoder skips a byte order mark.
  const text = new TextDecoder().decode(bytes.subarray(0, ENOUGH)).trimStart();
  if (/^(glTF|\{)/.test(text)) return undefined;
  const [, extension] = SCENES.exec(name) ?? [];
  if (extension) return `expected a .gltf or .glb file, found a .${extension} file (export the scene as glTF 2.0)`;
  return `expected a glTF document, found ${kind(bytes, text)}`;
}

/** Returns what a file is instead, and what to do about it where that is known. */
function kind(bytes, text) {
  if (bytes.length === 0) return 'an empty file; copy or export it again';
  if (text.startsWith('version https://git-lfs.github.com/spec/')) {
    return 'a Git LFS pointer instead of the file; run `git lfs pull`';
  }
  if (/^(<!doctype html|<html)/i.test(text)) return 'a web page; download the file itself';
  return 'something else';
}
