// What a bake did, as text.
import { footprint } from './viewer/density.js';

/** Returns a size for a person. */
export function size(bytes) {
  return bytes < 1e6 ? `${(bytes / 1e3).toFixed(1)} kB` : `${(bytes / 1e6).toFixed(2)} MB`;
}

const largest = (errors) => Math.max(...errors);

/** Returns the sentence on sizes and time. */
export function headline(before, { bytes, report, seconds }) {
  const ktx2 = report.textures.reduce((sum, texture) => sum + texture.bytes, 0);
  const textures = `${report.textures.length} KTX2 textures of ${size(ktx2)}`;
  if (report.textures.length === 0) return `No material has a normal or height map: the file stays as it is.`;
  return `${size(before)} before, ${size(bytes.byteLength)} baked, with ${textures}, in ${seconds.toFixed(1)} s.`;
}

/** Returns the sentences on the texels that a pixel covers, and on the samples of the truth. */
export function measured(texels, samples) {
  return `${footprint(texels)} ${samples > 0 ? `The truth has ${samples} samples per pixel.` : ''}`;
}

/** Returns a row for each texture that was written: name, content, size in texels, and bytes. */
export function textureRows({ textures }) {
  return textures.map(({ path, content, width, height, bytes }) => [
    path.replace(/^.*\/|\.ktx2$/g, ''),
    content,
    `${width} x ${height}`,
    size(bytes),
  ]);
}

/** Returns a row for each baked layer: material, model, and the largest lobe errors of plain mips and of the bake. */
export function layerRows({ layers }) {
  return layers
    .filter((layer) => layer.model)
    .map(({ material, layer, model, choice }) => {
      const name = layer === 'base' ? material : `${material}, ${layer}`;
      const plain = choice?.candidates.find((candidate) => candidate.model === 'none');
      const taken = choice?.candidates[choice.chosen];
      return [name, model, ...[plain, taken].map((one) => (one ? largest(one.errors).toFixed(2) : '–'))];
    });
}

/** Returns the notes that ask for something, and those on layers whose row shows no error. */
export function notes({ layers }) {
  return layers.flatMap(({ material, model, choice, notes }) =>
    notes.filter((note) => note.asksForAction || (model && !choice)).map((note) => `${material}: ${note.text}`),
  );
}
