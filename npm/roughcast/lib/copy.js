// Copies of properties between documents of glTF-Transform.
import { PropertyType } from '@gltf-transform/core';

/**
 * Returns a function that returns the counterpart of a property in `document`: a copy, which has copies of the
 * property's children.
 *
 * @param {import('@gltf-transform/core').Document} document
 * @param {Iterable<[Property, Property]>} known counterparts that exist already
 */
export function copier(document, known = []) {
  const counterparts = new Map(known);
  return function counterpart(property) {
    // A TextureInfo belongs to its material, which copies it.
    if (property.propertyType === PropertyType.TEXTURE_INFO) return property;
    if (!counterparts.has(property)) {
      const copy = new property.constructor(document.getGraph());
      counterparts.set(property, copy);
      copy.copy(property, counterpart);
    }
    return counterparts.get(property);
  };
}

/** Adds the extensions `constructors` to a document, as required where they are required in `source`. */
export function addExtensions(document, source) {
  for (const extension of source.getRoot().listExtensionsUsed()) {
    // Meshes of a document in memory are not compressed, and encoders may be missing.
    if (/_(draco_mesh|meshopt)_compression$/.test(extension.extensionName)) continue;
    const added = document.createExtension(extension.constructor);
    if (extension.isRequired()) added.setRequired(true);
  }
}
