// Whether a texture on the GPU has the levels of a file.

/**
 * Returns the mean absolute difference per channel, in bytes. `texels` is RGBA; the first channels of both are
 * compared.
 */
export function difference(texels, { channels, data }) {
  let sum = 0;
  for (let i = 0; i < data.length / channels; i++) {
    for (let c = 0; c < channels; c++) sum += Math.abs(texels[4 * i + c] - data[channels * i + c]);
  }
  return sum / data.length;
}

/** Returns the levels that an engine would generate from level 0: 2x2 boxes, for even sizes. */
export function regenerated(level0) {
  const all = [level0];
  while (all.at(-1).width > 1 || all.at(-1).height > 1) {
    const { width, height, channels, data } = all.at(-1);
    const [w, h] = [Math.max(1, width >> 1), Math.max(1, height >> 1)];
    const next = new Float64Array(w * h * channels);
    for (let y = 0; y < h; y++) {
      for (let x = 0; x < w; x++) {
        for (let c = 0; c < channels; c++) {
          const at = (i, j) =>
            data[(Math.min(2 * y + j, height - 1) * width + Math.min(2 * x + i, width - 1)) * channels + c];
          next[(y * w + x) * channels + c] = (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)) / 4;
        }
      }
    }
    all.push({ width: w, height: h, channels, data: next });
  }
  return all;
}

/**
 * The texture of `found` (see engines/probe.js) that is nearest to the levels of a file, with the largest difference of
 * any level to the file and, for comparison, to generated levels. Null where none has the size.
 */
export function match(found, file) {
  const generated = regenerated(file[0]);
  const largest = (texture, to) => Math.max(...texture.levels.map((texels, level) => difference(texels, to[level])));
  return found
    .filter((t) => t.width === file[0].width && t.height === file[0].height)
    .map((t) => ({ texture: t, ours: largest(t, file), theirs: largest(t, generated) }))
    .reduce((best, m) => (best === null || m.ours < best.ours ? m : best), null);
}
