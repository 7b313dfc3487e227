// The cells of the tables, on files that no tool wrote.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import test from 'node:test';
import { PYRAMID } from '../asset.js';
import { compare } from '../survival.js';

const KTX2 = [0xab, 0x4b, 0x54, 0x58, 0x20, 0x32, 0x30];
const PNG = [0x89, 0x50, 0x4e, 0x47];
const uri = (bytes) => `data:;base64,${Buffer.from(bytes).toString('base64')}`;

/** Makes a baked material whose image i is a KTX2 file that ends with i. */
function document() {
  return {
    meshes: [{ primitives: [{ attributes: { TANGENT: 0 }, material: 0 }] }],
    materials: [
      {
        normalTexture: { index: 0 },
        pbrMetallicRoughness: { metallicRoughnessTexture: { index: 1 } },
        extensions: {
          KHR_materials_anisotropy: { anisotropyStrength: 1, anisotropyTexture: { index: 2 } },
          [PYRAMID]: { offsetTexture: { index: 3 }, roughnessTexture: { index: 4 } },
        },
      },
    ],
    textures: [0, 1, 2, 3, 4].map((source) => ({ extensions: { KHR_texture_basisu: { source } } })),
    images: [0, 1, 2, 3, 4].map((i) => ({ uri: uri([...KTX2, i]) })),
  };
}

/** Returns the cells for a change of the document. */
function cells(t, change) {
  const folder = mkdtempSync(path.join(os.tmpdir(), 'roughcast-interop-'));
  t.after(() => rmSync(folder, { recursive: true, force: true }));
  const [before, after] = ['before', 'after'].map((name) => path.join(folder, `${name}.gltf`));
  const changed = document();
  change(changed);
  writeFileSync(before, JSON.stringify(document()));
  writeFileSync(after, JSON.stringify(changed));
  return compare(before, after);
}

test('an unchanged file keeps all', (t) => {
  assert.deepEqual(
    cells(t, () => {}),
    ['kept', 'kept', 'kept', 'kept', 'kept'],
  );
});

test('a recoded texture has lost its mips, and a renumbered one breaks the pyramid', (t) => {
  const recode = ({ images }) => (images[1].uri = uri(PNG));
  assert.equal(cells(t, recode)[0], 'roughness: PNG, no mips');
  const encode = ({ images }) => (images[1].uri = uri([...KTX2, 9]));
  assert.equal(cells(t, encode)[0], 'roughness: KTX2, other levels');
  const renumber = ({ textures }) => textures.unshift(textures.pop());
  assert.equal(cells(t, renumber)[4], 'broken');
});

test('absent parts are lost', (t) => {
  const remove = ({ materials: [material], meshes, textures }) => {
    delete material.extensions;
    delete material.normalTexture;
    meshes[0].primitives[0].attributes = {};
    textures.forEach((texture, source) => Object.assign(texture, { source, extensions: {} }));
  };
  assert.deepEqual(cells(t, remove), ['no normal, anisotropy', 'lost', 'lost', 'lost', 'lost']);
});

test('changed factors of anisotropy are seen', (t) => {
  const weaken = ({ materials }) => (materials[0].extensions.KHR_materials_anisotropy.anisotropyStrength = 0.5);
  assert.equal(cells(t, weaken)[2], 'changed');
});
