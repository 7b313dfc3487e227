// Bytes of textures on the GPU.

/** Returns the textures of all materials of a scene, each once. */
export function texturesOf(scene) {
  const textures = new Set();
  scene.traverse(({ material }) => {
    for (const value of [material ?? []].flat().flatMap(Object.values)) if (value?.isTexture) textures.add(value);
  });
  return [...textures];
}

/** Returns the bytes of all levels of a texture: the blocks of a compressed texture, or 4 bytes for each texel. */
function bytesOf({ mipmaps, image, generateMipmaps }) {
  if (mipmaps?.length) return mipmaps.reduce((sum, { data }) => sum + data.byteLength, 0);
  const finest = image.data?.byteLength ?? 4 * image.width * image.height;
  return generateMipmaps ? Math.round((finest * 4) / 3) : finest;
}

/** Returns the bytes of the textures of a scene. Textures that share an image are counted once. */
export function textureBytes(scene) {
  const images = new Map(texturesOf(scene).map((texture) => [texture.source, texture]));
  return [...images.values()].reduce((sum, texture) => sum + bytesOf(texture), 0);
}

const UNITS = [
  [1e6, 'MB'],
  [1e3, 'kB'],
];

/** Writes a number of bytes for people: `1.4 MB`. */
export function readable(bytes) {
  const [scale, unit] = UNITS.find(([limit]) => bytes >= limit) ?? [1, 'B'];
  const value = bytes / scale;
  return `${scale === 1 || value >= 100 ? Math.round(value) : value.toPrecision(2)} ${unit}`;
}
