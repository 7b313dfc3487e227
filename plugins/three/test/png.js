// 8-bit PNG without interlace, as `roughcast inspect --extract` writes it.
import { inflateSync } from 'node:zlib';

/** @returns {{width: number, height: number, channels: number, data: Uint8Array}} */
export function decodePng(file) {
  let [at, header] = [8, null];
  const parts = [];
  while (at < file.length) {
    const length = file.readUInt32BE(at);
    const type = file.toString('latin1', at + 4, at + 8);
    const data = file.subarray(at + 8, at + 8 + length);
    if (type === 'IHDR')
      header = { width: data.readUInt32BE(0), height: data.readUInt32BE(4), depth: data[8], colour: data[9] };
    if (type === 'IDAT') parts.push(data);
    at += 12 + length;
  }
  const { width, height, depth, colour } = header;
  const channels = { 0: 1, 2: 3, 4: 2, 6: 4 }[colour];
  if (depth !== 8 || channels === undefined)
    throw new Error(`PNG: expected 8 bits, found ${depth} of colour type ${colour}`);
  const [raw, stride] = [inflateSync(Buffer.concat(parts)), width * channels];
  const data = new Uint8Array(stride * height);
  for (let y = 0; y < height; y++) {
    const filter = raw[y * (stride + 1)];
    for (let x = 0; x < stride; x++) {
      const a = x < channels ? 0 : data[y * stride + x - channels];
      const b = y === 0 ? 0 : data[(y - 1) * stride + x];
      const c = x < channels || y === 0 ? 0 : data[(y - 1) * stride + x - channels];
      data[y * stride + x] = raw[y * (stride + 1) + 1 + x] + [0, a, b, (a + b) >> 1, paeth(a, b, c)][filter];
    }
  }
  return { width, height, channels, data };
}

function paeth(a, b, c) {
  const [pa, pb, pc] = [b - c, a - c, a + b - 2 * c].map(Math.abs);
  return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
}
