// Files that a person drops on the page or chooses.
import { isOtherScene, refusal } from './refusal.js';
import { TITLES, readDocument, variantOf } from './variants.js';

/** Returns the files of an entry of a drop, folders included, as [path, file]. */
async function filesOf(entry) {
  if (entry.isFile) return [[entry.fullPath.slice(1), await new Promise((...done) => entry.file(...done))]];
  const [reader, files] = [entry.createReader(), []];
  // A reader returns some of the entries at a time, and in the end none.
  for (;;) {
    const entries = await new Promise((...done) => reader.readEntries(...done));
    if (entries.length === 0) return files;
    files.push(...(await Promise.all(entries.map(filesOf))).flat());
  }
}

/**
 * Calls `opened` with a promise of the files by path, when files are dropped on `frame` or chosen by `input`. Folders
 * take time to be read. A frame that files are over has the attribute data-over.
 */
export function listen(frame, input, opened) {
  let depth = 0;
  const over = (by) => {
    depth = by === 0 ? 0 : depth + by;
    frame.toggleAttribute('data-over', depth > 0);
  };
  frame.addEventListener('dragenter', () => over(1));
  frame.addEventListener('dragleave', () => over(-1));
  frame.addEventListener('dragover', (event) => event.preventDefault());
  frame.addEventListener('drop', (event) => {
    event.preventDefault();
    over(0);
    // Items are gone after the first pause.
    const items = [...event.dataTransfer.items].filter(({ kind }) => kind === 'file');
    const found = items.map((item) => {
      const entry = item.webkitGetAsEntry();
      const file = item.getAsFile();
      return entry ? filesOf(entry) : [[file.name, file]];
    });
    opened(Promise.all(found).then((files) => new Map(files.flat())));
  });
  input.addEventListener('change', () => {
    opened(Promise.resolve(new Map([...input.files].map((file) => [file.webkitRelativePath || file.name, file]))));
    input.value = '';
  });
}

/**
 * Returns the documents among files, by the variant that each is.
 *
 * @param {Map<string, File>} files By path.
 * @throws Error where no document is among the files, a document cannot be read, or two documents are one variant.
 */
export async function documents(files) {
  const found = new Map();
  for (const [path, file] of files) {
    if (!/\.(gltf|glb)$/i.test(path)) continue;
    const bytes = new Uint8Array(await file.arrayBuffer());
    refuse(path, bytes);
    let variant;
    try {
      variant = variantOf(readDocument(bytes));
    } catch (error) {
      throw new Error(`${path} is no glTF: ${error.message}`);
    }
    if (found.has(variant))
      throw new Error(`${found.get(variant)} and ${path} are both “${TITLES[variant]}”: drop one of them`);
    found.set(variant, path);
  }
  if (found.size === 0) {
    // A scene in another format is what a person wanted to see.
    const scene = [...files.keys()].find(isOtherScene);
    if (scene) refuse(scene, new Uint8Array());
    throw new Error('No .glb or .gltf was dropped: drop one with all its files');
  }
  return found;
}

/** Throws an Error where a file is no document. */
function refuse(path, bytes) {
  const reason = refusal(path, bytes);
  if (reason) throw new Error(`${path}: ${reason}`);
}
