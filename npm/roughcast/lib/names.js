// Names and kinds of files.

/** Returns whether bytes are a .glb. */
export function isGlb(bytes) {
  return bytes[0] === 0x67 && bytes[1] === 0x6c && bytes[2] === 0x54 && bytes[3] === 0x46;
}

/** Returns the file name of a path without its extension. */
export function stem(path) {
  const name = path.slice(Math.max(path.lastIndexOf('/'), path.lastIndexOf('\\')) + 1);
  return name.replace(/(?<=.)\.[^.]*$/, '');
}
