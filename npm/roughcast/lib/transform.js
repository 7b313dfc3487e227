// The transform for documents of glTF-Transform.
import { Document, Root, WebIO } from '@gltf-transform/core';
import { KHRMaterialsAnisotropy, KHRTextureBasisu } from '@gltf-transform/extensions';
import { bake } from './bake.js';
import { addExtensions, copier } from './copy.js';
import { RoughnessPyramid } from './roughness-pyramid.js';
import { nameBaked, nameSources } from './texture-names.js';

/** Engines that cannot show what the transform makes, and why. docs/engines.md describes them. */
const NEED_BAKE = {
  bevy: 'Bevy refuses documents that require KHR_texture_basisu',
  godot: 'Godot drops the mips of images inside a .glb',
};

/** Extensions that textures of one MIME type need. */
const IMAGE_TYPES = { EXT_texture_webp: 'image/webp', EXT_texture_avif: 'image/avif' };

/** Returns a transform that bakes the materials of a document; index.d.ts describes its options. */
export function roughcast({ backend, threads, onProgress, onReport, ...settings } = {}) {
  refuseEngine(settings.engine);
  // The name is what the log of glTF-Transform shows.
  return Object.defineProperty(transform, 'name', { value: 'roughcast' });

  /** Bakes a document in place. */
  async function transform(document) {
    const io = new WebIO().registerExtensions([
      ...document
        .getRoot()
        .listExtensionsUsed()
        .map((extension) => extension.constructor),
      KHRMaterialsAnisotropy,
      KHRTextureBasisu,
      RoughnessPyramid,
    ]);
    // A .gltf, since messages name the files of its textures. Images of a .glb have no names there.
    const { json, resources: files } = await io.writeJSON(partToBake(document, needsMeshes(settings)));
    const source = new TextEncoder().encode(JSON.stringify(json));
    // glTF-Transform knows one image for each texture, which is the KTX2: a fallback beside it would be lost.
    const strict = { ...settings, gltf: 'strict', glb: true };
    const result = await bake(source, { files, settings: strict, backend, threads, onProgress });
    replaceMaterials(document, await io.readBinary(result.document.bytes), result.report, settings);
    log(document.getLogger(), result.report);
    onReport?.(result.report);
  }
}

/** Throws if an engine cannot show what the transform makes. */
function refuseEngine(engine) {
  if (!Object.hasOwn(NEED_BAKE, engine ?? '')) return;
  const found = `engine: expected an engine that shows the output of this transform, found ${engine}`;
  const remedy = 'use bake() or the command line, which write a .gltf with its textures beside it';
  throw new Error(`${found}: ${NEED_BAKE[engine]}; ${remedy}`);
}

/** Returns whether a bake reads meshes, as crates/core/src/bake/geometry.rs decides. */
function needsMeshes({ frame = 'unit', nearest }) {
  return frame !== 'unit' || nearest !== undefined;
}

/** Returns a new document with the materials of `document`, and with everything else if meshes are needed. */
function partToBake(document, withMeshes) {
  const part = new Document();
  addExtensions(part, document);
  const root = document.getRoot();
  const counterpart = copier(part, [[root, part.getRoot()]]);
  if (withMeshes) part.getRoot().copy(root, counterpart);
  else root.listMaterials().forEach(counterpart);
  nameSources(part);
  // glTF-Transform chooses other URIs, which are distinct and name files beside the document.
  for (const buffer of part.getRoot().listBuffers()) buffer.setURI('');
  for (const material of part.getRoot().listMaterials()) leaveOutHeightTexture(material, document.getLogger());
  return part;
}

/** Takes the height texture out of a material: its index was one of the file, whose order of textures is gone. */
function leaveOutHeightTexture(material, logger) {
  const { roughcast, ...extras } = material.getExtras();
  if (!roughcast?.heightTexture) return;
  material.setExtras(extras);
  const why = 'glTF-Transform does not keep the order of textures, by which extras name the height texture';
  logger.warn(`roughcast: ${material.getName()}: ${why}. Bake the file with the command line or bake() instead.`);
}

/**
 * Makes the materials of `document` those of `baked`, which has the same materials in the same order. Without bumps a
 * material changes only if all textures are written.
 */
function replaceMaterials(document, baked, report, { textures }) {
  addExtensions(document, baked);
  const before = new Set(document.getRoot().listTextures());
  const counterpart = copier(document, sameTextures(before, baked.getRoot().listTextures()));
  const isChanged = (layer) => textures === 'all' || layer.model !== undefined;
  const changed = new Set(report.layers.filter(isChanged).map((layer) => layer.index));
  for (const index of changed) {
    const material = document.getRoot().listMaterials()[index];
    const [extras, extensions] = [material.getExtras(), material.listExtensions()];
    material.copy(baked.getRoot().listMaterials()[index], counterpart).setExtras(extras);
    extensions.filter(isUnused).forEach((extension) => extension.dispose());
  }
  [...before].filter(isUnused).forEach((texture) => texture.dispose());
  nameBaked(document, before);
  disposeImageTypes(document);
}

/** Disposes extensions for images of a type of which no texture is left. */
function disposeImageTypes(document) {
  const root = document.getRoot();
  const types = new Set(root.listTextures().map((texture) => texture.getMimeType()));
  for (const extension of root.listExtensionsUsed()) {
    const type = IMAGE_TYPES[extension.extensionName];
    if (type && !types.has(type)) extension.dispose();
  }
}

/** Returns whether nothing but the list of all properties refers to a property. */
function isUnused(property) {
  return property.listParents().every((parent) => parent instanceof Root);
}

/** Returns the textures of `baked` whose images are those of textures of the document, with these textures. */
function sameTextures(textures, baked) {
  const pairs = [];
  for (const texture of baked) {
    const same = [...textures].find((other) => isEqual(texture.getImage(), other.getImage()));
    if (same) pairs.push([texture, same]);
  }
  return pairs;
}

function isEqual(a, b) {
  return a?.byteLength === b?.byteLength && a.every((byte, index) => byte === b[index]);
}

/** Logs what became of each layer. Notes that ask for something are warnings. */
function log(logger, { layers }) {
  for (const { material, layer, model, notes } of layers) {
    logger.debug(`roughcast: ${material}, ${layer}: ${model ? `baked, model ${model}` : 'not baked'}`);
    for (const note of notes) {
      if (note.asksForAction) logger.warn(`roughcast: ${material}, ${layer}: ${note.text}`);
    }
  }
}
