// The transform of documents, and the extension's round trip.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { Document, Logger, NodeIO, Verbosity } from '@gltf-transform/core';
import { ALL_EXTENSIONS, EXTTextureWebP } from '@gltf-transform/extensions';
import { dedup, prune } from '@gltf-transform/functions';
import { RoughnessPyramid, bake, roughcast } from 'roughcast';
import { fixtures, noModule } from './common.js';

const NAME = 'ROUGHCAST_materials_roughness_pyramid';
const options = { skip: noModule };
const backend = 'wasm';

/** Returns a reader and writer, whose log is collected in `warnings`. */
function newIO() {
  const io = new NodeIO().registerExtensions([...ALL_EXTENSIONS, RoughnessPyramid]);
  const logger = new Logger(Verbosity.WARN);
  io.warnings = [];
  logger.warn = (text) => io.warnings.push(text);
  return io.setLogger(logger);
}

const read = (name) => newIO().read(path.join(fixtures, name));

/** Bakes a fixture to a .glb without glTF-Transform. */
async function bakeFixture(name, settings) {
  const file = path.join(fixtures, name);
  const files = (beside) => readFileSync(path.join(path.dirname(file), beside));
  const { document } = await bake(readFileSync(file), { files, settings: { ...settings, glb: true }, backend });
  return document.bytes;
}

/** Returns the members of a textureInfo with its image and sampler instead of indices. */
function resolved(json, images, info) {
  const texture = json.textures[info.index];
  const { index, ...rest } = info;
  const source = texture.extensions?.KHR_texture_basisu?.source ?? texture.source;
  const { wrapS = 10497, wrapT = 10497, magFilter, minFilter } = json.samplers?.[texture.sampler] ?? {};
  // glTF-Transform leaves out the default of texCoord.
  if (rest.texCoord === 0) delete rest.texCoord;
  return { ...rest, image: images[source], wrapS, wrapT, magFilter, minFilter };
}

/** Returns the extension objects of the materials of a .glb, with images instead of indices. */
async function pyramids(glb) {
  const bytes = Buffer.from(glb);
  const length = bytes.readUInt32LE(12);
  const json = JSON.parse(bytes.toString('utf8', 20, 20 + length));
  const bin = bytes.subarray(20 + length + 8);
  const images = json.images.map(({ bufferView }) => {
    const { byteOffset = 0, byteLength } = json.bufferViews[bufferView];
    return bin.subarray(byteOffset, byteOffset + byteLength).toString('base64');
  });
  const withImages = (value) => {
    if (Array.isArray(value) || typeof value !== 'object' || value === null) return value;
    if (Number.isInteger(value.index)) return resolved(json, images, value);
    return Object.fromEntries(Object.entries(value).map(([name, member]) => [name, withImages(member)]));
  };
  return json.materials.map((material) => withImages(material.extensions?.[NAME]));
}

for (const [name, settings] of [
  ['waves/waves.glb', { profile: 'both' }],
  ['brushed/brushed.gltf', { profile: 'both', model: 'anisotropic' }],
  ['knobs/knobs.gltf', { profile: 'both', frame: 'natural' }],
  ['tiny/tiny.gltf', { profile: 'pyramid', frame: 'main-direction' }],
]) {
  test(`the extension of ${name} survives a round trip`, options, async () => {
    const baked = await bakeFixture(name, settings);
    const io = newIO();
    const written = await io.writeBinary(await io.readBinary(baked));
    const expected = await pyramids(baked);
    assert.ok(expected.some((pyramid) => pyramid !== undefined));
    assert.deepEqual(await pyramids(written), expected);
    // A fixture has an extension of nobody.
    assert.deepEqual(
      io.warnings.filter((text) => !text.includes('EXT_example')),
      [],
    );
  });
}

test('dedup and prune keep the textures of the extension', options, async () => {
  const io = newIO();
  const baked = await bakeFixture('waves/waves.glb', { profile: 'both' });
  const document = await io.readBinary(baked);
  await document.transform(dedup(), prune());
  assert.deepEqual(await pyramids(await io.writeBinary(document)), await pyramids(baked));
});

test('a document without the extension is written without it', async () => {
  const io = newIO();
  const document = new Document();
  document.createExtension(RoughnessPyramid);
  document.createMaterial();
  const { json } = await io.writeJSON(document);
  assert.equal(json.materials[0].extensions, undefined);
});

test('an unknown version is left out with a warning', options, async () => {
  const io = newIO();
  const { json, resources } = await io.writeJSON(
    await io.readBinary(await bakeFixture('waves/waves.glb', { profile: 'pyramid' })),
  );
  json.materials.forEach((material) => material.extensions && (material.extensions[NAME].formatVersion = 3));
  const document = await io.readJSON({ json, resources });
  assert.equal(document.getRoot().listMaterials()[0].getExtension(NAME), null);
  assert.match(io.warnings[0], /formatVersion 2, found 3/);
});

test('the transform writes what a bake of the document writes', options, async () => {
  for (const [name, settings] of [
    ['waves/waves.glb', { profile: 'both' }],
    ['knobs/knobs.gltf', { profile: 'portable' }],
    ['brushed/brushed.gltf', { profile: 'both', frame: 'natural' }],
    ['brushed/brushed.gltf', { textures: 'all', maxSize: 64 }],
  ]) {
    // Provenance names the images of the source document, which are those of another document in the transform.
    const all = { ...settings, provenance: false };
    const document = await read(name);
    await document.transform(roughcast({ ...all, backend }));
    const direct = await newIO().readBinary(await bakeFixture(name, { ...all, gltf: 'strict' }));
    const images = (doc) =>
      doc
        .getRoot()
        .listTextures()
        .map((texture) => Buffer.from(texture.getImage()).toString('base64'));
    const ktx2 = (doc) =>
      doc
        .getRoot()
        .listTextures()
        .filter((texture) => texture.getMimeType() === 'image/ktx2').length;
    assert.ok(ktx2(document) > 0);
    assert.deepEqual(images(document).sort(), images(direct).sort(), name);
    const io = newIO();
    assert.deepEqual(
      await pyramids(await io.writeBinary(document)),
      await pyramids(await io.writeBinary(direct)),
      name,
    );
  }
});

test('meshes, other textures, names and unbaked materials stay', options, async () => {
  const document = await read('brushed/brushed.gltf');
  const root = document.getRoot();
  const flat = document.createMaterial('flat').setRoughnessFactor(0.7);
  const colour = root.listMaterials()[0].getBaseColorTexture();
  const before = {
    meshes: root.listMeshes(),
    accessors: root.listAccessors(),
    uri: colour.getURI(),
    image: colour.getImage(),
  };
  let report;
  await document.transform(roughcast({ backend, onReport: (made) => (report = made) }));
  const material = root.listMaterials()[0];
  assert.equal(material.getBaseColorTexture(), colour);
  assert.deepEqual([colour.getURI(), colour.getImage()], [before.uri, before.image]);
  assert.deepEqual([root.listMeshes(), root.listAccessors()], [before.meshes, before.accessors]);
  assert.equal(material.getNormalTexture().getMimeType(), 'image/ktx2');
  assert.equal(root.listMeshes()[0].listPrimitives()[0].getMaterial(), material);
  assert.equal(flat.getRoughnessFactor(), 0.7);
  assert.ok(report.layers.some((layer) => layer.model));
  // The maps that were replaced are gone.
  assert.ok(root.listTextures().every((texture) => texture.listParents().length > 1));
});

test('the transform reports progress and logs what asks for action', options, async () => {
  const io = newIO();
  const document = await io.read(path.join(fixtures, 'knobs/knobs.gltf'));
  const shares = [];
  await document.transform(roughcast({ backend, engine: 'filament', onProgress: (share) => shares.push(share) }));
  assert.ok(io.warnings.some((text) => text.startsWith('roughcast: Label, base: the roughness texture has other')));
  assert.equal(shares.at(-1), 1);
  assert.deepEqual(
    shares,
    [...shares].sort((a, b) => a - b),
  );
});

test('new textures have names and URIs after their sources', options, async () => {
  const document = await read('brushed/brushed.gltf');
  const root = document.getRoot();
  const [material] = root.listMaterials();
  // The name is taken, by a texture that stays.
  root.listTextures()[0].setURI('Brushed_Normal.ktx2');
  await document.transform(roughcast({ backend }));
  const namesOf = (texture) => [texture.getName(), texture.getURI()];
  assert.deepEqual(namesOf(material.getNormalTexture()), ['brushed_normal', 'brushed_normal-2.ktx2']);
  assert.deepEqual(namesOf(material.getMetallicRoughnessTexture()), ['brushed_surface', 'brushed_surface.ktx2']);
  const { json, resources } = await newIO().writeJSON(document);
  for (const { uri } of json.images) assert.ok(resources[uri], uri);

  const glb = await read('waves/waves.glb');
  await glb.transform(roughcast({ backend }));
  assert.deepEqual(
    glb.getRoot().listTextures().map(namesOf),
    [
      ['waves_colour', ''],
      ['waves_normal', 'waves_normal.ktx2'],
      ['Lake.roughness', 'Lake.roughness.ktx2'],
    ],
  );
});

test('messages name the texture', options, async () => {
  const document = await read('waves/waves.glb');
  document.getRoot().listMaterials()[0].getNormalTexture().setImage(new Uint8Array(9)).setMimeType('image/png');
  await assert.rejects(document.transform(roughcast({ backend })), /material Lake, texture waves_normal\.png: /);
});

/** A WebP of 4 x 4 texels. */
const WEBP = new Uint8Array(Buffer.from('UklGRh4AAABXRUJQVlA4TBEAAAAvA8AAAAdQrdIWpf+BiOh/AAA=', 'base64'));

test('the extension of WebP stays as long as a texture needs it', options, async () => {
  for (const [textures, remains] of [
    ['bumps', true],
    ['all', false],
  ]) {
    const document = await read('brushed/brushed.gltf');
    document.createExtension(EXTTextureWebP).setRequired(true);
    const colour = document.getRoot().listMaterials()[0].getBaseColorTexture();
    colour.setImage(WEBP).setMimeType('image/webp').setURI('colour.webp');
    await document.transform(roughcast({ backend, textures }));
    const { json } = await newIO().writeJSON(document);
    assert.equal(json.extensionsUsed.includes('EXT_texture_webp'), remains, textures);
    assert.equal(json.extensionsRequired.includes('EXT_texture_webp'), remains, textures);
  }
});

test('engines that cannot show the output are refused', () => {
  for (const engine of ['bevy', 'godot']) {
    assert.throws(() => roughcast({ engine }), new RegExp(`found ${engine}: .*; use bake\\(\\)`));
  }
});

test('a wrong setting rejects and leaves the document as it was', options, async () => {
  const document = await read('waves/waves.glb');
  const textures = document.getRoot().listTextures();
  await assert.rejects(document.transform(roughcast({ maxError: 7, backend })), /max-error/);
  await assert.rejects(document.transform(roughcast({ maxEror: 0.1, backend })), /settings: .*maxError.*found maxEror/);
  assert.deepEqual(document.getRoot().listTextures(), textures);
});

test('a height texture, which extras name by index, is left out with a warning', options, async () => {
  const io = newIO();
  const document = await io.read(path.join(fixtures, 'heights/heights.gltf'));
  const [material] = document.getRoot().listMaterials();
  const extras = material.getExtras();
  await document.transform(roughcast({ backend }));
  assert.match(io.warnings.join(), /height texture.*command line/);
  assert.deepEqual(material.getExtras(), extras);
});
