// Uses of the library that must type-check; lines below @ts-expect-error must not.
import { Document, WebIO } from '@gltf-transform/core';
import { Pyramid, RoughnessPyramid, bake, roughcast } from 'roughcast';
import { bakeMap } from 'roughcast/bake';
import type { Report } from 'roughcast';

export async function transform(document: Document): Promise<Report> {
  let report: Report = { version: '', settings: {}, layers: [], textures: [] };
  await document.transform(
    roughcast({ profile: 'both', engine: 'three', maxError: 0.05, onReport: (made) => (report = made) }),
  );
  // @ts-expect-error: no such profile
  roughcast({ profile: 'all' });
  // @ts-expect-error: glTF-Transform knows one image for each texture
  roughcast({ gltf: 'fallback' });
  // @ts-expect-error: Bevy needs a .gltf of bake()
  roughcast({ engine: 'bevy' });
  return report;
}

export async function bytes(glb: Uint8Array): Promise<Uint8Array> {
  const { document, files, copies, report } = await bake(glb, {
    name: 'helmet',
    files: { 'helmet.bin': new Uint8Array(4) },
    settings: { glb: true, rdo: 0.5 },
    onProgress: (share) => share.toFixed(2),
  });
  const errors: number[] | undefined = report.layers[0]?.choice?.candidates[0]?.errors;
  console.log(files.length, copies.join(), errors);
  await bake(glb, { threads: 2 });
  await bake(glb, { files: async (path) => (path === 'a.png' ? new Uint8Array(1) : null), backend: 'wasm' });
  // @ts-expect-error: not bytes
  await bake('helmet.glb');
  return document.bytes;
}

export async function map(image: Uint8Array): Promise<string> {
  const { files, report } = await bakeMap(image, { height: true, heightScale: 0.02, wrap: ['repeat', 'clamp'] });
  // @ts-expect-error: a setting of documents
  await bakeMap(image, { settings: { engine: 'three' } });
  return files.map((file) => file.path).join() + report.model;
}

export function roundTrip(document: Document): WebIO {
  const extension = document.createExtension(RoughnessPyramid);
  const pyramid: Pyramid = extension.createPyramid().setValue('frame', 'unit').setBaseLobe({ roughnessFactor: 0.3 });
  const scale: [number, number] = pyramid.getValue('offsetScale');
  // @ts-expect-error: no such frame
  pyramid.setValue('frame', 'world');
  document.createMaterial().setExtension('ROUGHCAST_materials_roughness_pyramid', pyramid);
  console.log(scale, pyramid.getOffsetTextureInfo()?.getTexCoord());
  return new WebIO().registerExtensions([RoughnessPyramid]);
}
