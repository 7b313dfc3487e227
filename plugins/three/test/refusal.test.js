// What is said of files that are no glTF documents.
import assert from 'node:assert/strict';
import test from 'node:test';
import { isOtherScene, refusal } from '../page/refusal.js';

const of = (name, text) => refusal(name, Buffer.from(text, 'latin1'));
const POINTER = 'version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n';

test('takes what looks like a document', () => {
  for (const text of ['glTF\x02\0\0\0', '{}', ' \r\n{', '\xef\xbb\xbf{']) {
    assert.equal(of('model.glb', text), undefined);
  }
  assert.equal(of('model.vrm', 'glTF\x02\0\0\0'), undefined, 'the content decides');
});

test('says what another file is, and quotes no bytes', () => {
  for (const [name, text, found] of [
    ['model.glb', POINTER, 'a Git LFS pointer instead of the file; run `git lfs pull`'],
    ['model.gltf', '', 'an empty file; copy or export it again'],
    ['model.glb', '\n<!DOCTYPE html>', 'a web page; download the file itself'],
    ['map.ktx2', '\xabKTX 20\xbb\r\n\x1a\n', 'something else'],
    ['model.gltf', '[]', 'something else'],
    ['model.glb', '\x01\x02', 'something else'],
  ]) {
    assert.equal(of(name, text), `expected a glTF document, found ${found}`);
  }
});

test('names scenes in other formats', () => {
  const expected = 'expected a .gltf or .glb file, found a .FBX file (export the scene as glTF 2.0)';
  for (const text of ['Kaydara FBX Binary  \0', '', POINTER]) assert.equal(of('scenes/m.FBX', text), expected);
  assert.deepEqual(['a.usdz', 'fbx', 'a.glb', 'a.fbx.png'].map(isOtherScene), [true, false, false, false]);
});
