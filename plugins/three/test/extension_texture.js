// Texture coordinates and filters, written from docs/extension/README.md and glTF.

/** Returns the transform of a textureInfo ("Textures"): a matrix and an offset. */
export function transform({ extensions }) {
  const { offset = [0, 0], rotation = 0, scale = [1, 1] } = extensions?.KHR_texture_transform ?? {};
  const [c, s] = [Math.cos(rotation), Math.sin(rotation)];
  const matrix = [
    [scale[0] * c, scale[1] * s],
    [-scale[0] * s, scale[1] * c],
  ];
  return { matrix, offset };
}

/** Returns texture coordinates after the transform of a textureInfo. */
export function transformed(info, [u, v]) {
  const { matrix, offset } = transform(info);
  return matrix.map(([a, b], i) => a * u + b * v + offset[i]);
}

export const REPEAT = 10497;
export const CLAMP_TO_EDGE = 33071;
const WRAPS = {
  [REPEAT]: (i, size) => ((i % size) + size) % size,
  [CLAMP_TO_EDGE]: (i, size) => Math.min(Math.max(i, 0), size - 1),
};

const mix = (a, b, t) => a.map((value, i) => value + t * (b[i] - value));

/** Returns the bilinear mean of four texels of a level. */
export function bilinear({ width, height, texels }, wrap, [u, v]) {
  const [x, y] = [u * width - 0.5, v * height - 0.5];
  const [column, row] = [Math.floor(x), Math.floor(y)];
  const texel = (i, j) => texels[WRAPS[wrap](row + j, height) * width + WRAPS[wrap](column + i, width)];
  const [upper, lower] = [0, 1].map((j) => mix(texel(0, j), texel(1, j), x - column));
  return mix(upper, lower, y - row);
}

/** Returns the level of detail where `squared` is the square of the largest distance between two pixels, in texels. */
export const exactLevel = (squared) => 0.5 * Math.log2(squared);

/**
 * Samples a texture with the trilinear filter. `derivatives` are those of the texture coordinates by the pixels across
 * and down, and `levelOf` is `exactLevel` or a GPU's approximation of it.
 */
export function trilinear({ levels, wrap }, uv, derivatives, levelOf) {
  const [{ width, height }] = levels;
  const squared = Math.max(...derivatives.map(([u, v]) => (u * width) ** 2 + (v * height) ** 2));
  const level = Math.min(Math.max(levelOf(squared), 0), levels.length - 1);
  const [fine, coarse] = [Math.floor(level), Math.ceil(level)].map((i) => bilinear(levels[i], wrap, uv));
  return mix(fine, coarse, level - Math.floor(level));
}
