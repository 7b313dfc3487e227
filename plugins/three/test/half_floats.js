// Textures of half floats in KTX2 files.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';

/** Channels by VkFormat. */
const CHANNELS = { 76: 1, 83: 2, 97: 4 };

/** Reads the levels of a file without supercompression. Texels stand row by row, each with its channels. */
export function halfFloats(file) {
  const bytes = readFileSync(file);
  const [format, , width, height] = [12, 16, 20, 24].map((at) => bytes.readUInt32LE(at));
  const [count, scheme] = [40, 44].map((at) => bytes.readUInt32LE(at));
  const channels = CHANNELS[format];
  assert.ok(channels && scheme === 0, `half floats without supercompression: ${format}, ${scheme}`);
  return Array.from({ length: count }, (_, level) => {
    const start = Number(bytes.readBigUInt64LE(80 + 24 * level));
    const size = { width: Math.max(width >> level, 1), height: Math.max(height >> level, 1) };
    const half = (i) => fromHalf(bytes.readUInt16LE(start + 2 * i));
    const texel = (_, i) => Array.from({ length: channels }, (_, c) => half(channels * i + c));
    return { ...size, texels: Array.from({ length: size.width * size.height }, texel) };
  });
}

/** Returns the value of a half float from its bits. */
export function fromHalf(bits) {
  const [sign, exponent, fraction] = [bits & 0x8000 ? -1 : 1, (bits >> 10) & 31, bits & 1023];
  if (exponent === 0) return sign * fraction * 2 ** -24;
  return sign * (1 + fraction / 1024) * 2 ** (exponent - 15);
}
