// Messages to and from the WebAssembly module; npm/wasm/src/message.rs describes them.

/**
 * Writes a request.
 *
 * @param {object} header
 * @param {{path: string, bytes: Uint8Array}[]} files
 * @returns {Uint8Array[]} its parts, in order
 */
export function encodeRequest(header, files) {
  const entries = files.map(({ path, bytes }) => ({ path, length: bytes.byteLength }));
  const text = new TextEncoder().encode(JSON.stringify({ ...header, files: entries }));
  const length = new Uint8Array(4);
  new DataView(length.buffer).setUint32(0, text.byteLength, true);
  return [length, text, ...files.map((file) => file.bytes)];
}

/** Returns the UTF-8 text at an address. */
export function textAt(memory, address, length) {
  // Browsers do not decode memory that threads share, so that the bytes are copied.
  return new TextDecoder().decode(new Uint8Array(memory, address, length).slice());
}

/**
 * Reads a response. Its bytes are copied.
 *
 * @param {ArrayBuffer | SharedArrayBuffer} memory
 * @param {number} address of the length, which the message follows
 */
export function decodeResponse(memory, address) {
  const view = new DataView(memory);
  const headerLength = view.getUint32(address + 4, true);
  const { files, ...header } = JSON.parse(textAt(memory, address + 8, headerLength));
  let at = address + 8 + headerLength;
  const read = files.map(({ path, length }) => {
    at += length;
    return { path, bytes: new Uint8Array(memory, at - length, length).slice() };
  });
  return { header, files: read };
}
