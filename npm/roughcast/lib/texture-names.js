// Names and URIs of textures in documents of glTF-Transform.
import { ImageUtils } from '@gltf-transform/core';
import { stem } from './names.js';

/** Most characters of the stem of a URI: file systems allow 255 bytes for a name, and a character has 4 at most. */
const MAX_STEM = 50;

/** Gives each texture of a document a URI of its own, and a name, from which the bake makes names of new textures. */
export function nameSources(document) {
  const uriOf = uniqueUris([]);
  for (const [index, texture] of document.getRoot().listTextures().entries()) {
    const name = texture.getName() || stem(decoded(texture.getURI())) || `image${index}`;
    texture.setName(name).setURI(uriOf(name, ImageUtils.mimeTypeToExtension(texture.getMimeType())));
  }
}

/** Gives each texture of a document that is not one of the set `before` a URI after its name. */
export function nameBaked(document, before) {
  const textures = document.getRoot().listTextures();
  const uriOf = uniqueUris(textures.map((texture) => texture.getURI()));
  for (const texture of textures.filter((texture) => !before.has(texture))) {
    texture.setURI(uriOf(texture.getName(), ImageUtils.mimeTypeToExtension(texture.getMimeType())));
  }
}

/**
 * Returns a function that returns a new URI for a name and an extension. From the second such URI on, a number is
 * added. URIs that differ by case only are one file on some file systems.
 */
function uniqueUris(taken) {
  const used = new Set(taken.map((uri) => uri.toLowerCase()));
  return (name, extension) => {
    for (let number = 1; ; number++) {
      const uri = `${portable(name)}${number === 1 ? '' : `-${number}`}.${extension}`;
      if (used.has(uri.toLowerCase())) continue;
      used.add(uri.toLowerCase());
      return uri;
    }
  };
}

/** Returns a name that every file system allows, and whose URI needs no percent-encoding. */
function portable(name) {
  const characters = [...name].map((character) => (/[\p{L}\p{N}._-]/u.test(character) ? character : '_'));
  return characters.slice(0, MAX_STEM).join('');
}

/** Returns a URI without its percent-encoding. */
function decoded(uri) {
  try {
    return decodeURIComponent(uri);
  } catch {
    return uri;
  }
}
