// What is seen first: texels in a pixel, and the share of the picture that an asset takes.
import assert from 'node:assert/strict';
import test from 'node:test';
import * as THREE from 'three';
import { texelsPerUnit } from '../page/density.js';
import { TEXELS, first, firstKind, pixelWidth } from '../page/start.js';
import { subject } from '../page/subject.js';

/** Pixels along the shorter side of the picture. */
const PIXELS = 600;

/** Returns an asset of one mesh with a square normal map of so many texels along a side, or without a map. */
function asset(geometry, side) {
  const material = new THREE.MeshStandardMaterial();
  if (side) material.normalMap = Object.assign(new THREE.Texture(), { image: { width: side, height: side } });
  return new THREE.Group().add(new THREE.Mesh(geometry, material));
}

/** Returns the texels that a pixel covers in the first view. */
function texels(scene, kind) {
  const { distance, repeats } = first(scene, kind, PIXELS);
  return texelsPerUnit(subject(scene, kind, repeats)) * pixelWidth(distance, PIXELS);
}

/** Returns the share of the picture that a side of the asset of `subject` takes in the first view. */
function share(scene) {
  const { distance } = first(scene, 'asset', PIXELS);
  return Math.max(...subject(scene, 'asset').userData.size) / (pixelWidth(distance, PIXELS) * PIXELS);
}

test('a pixel covers the wanted texels where the size of the asset allows it', () => {
  for (const side of [1536, 2048]) {
    const scene = asset(new THREE.PlaneGeometry(5, 5), side);
    assert.ok(Math.abs(texels(scene, 'asset') - TEXELS) < 1e-6, `${side}`);
    assert.ok(share(scene) > 1 / 3 && share(scene) < 1, `${share(scene)}`);
  }
});

test('an asset with few texels or without a map takes a third of the picture', () => {
  for (const side of [128, undefined]) {
    for (const geometry of [new THREE.SphereGeometry(7), new THREE.BoxGeometry(0.1, 3, 0.2)]) {
      const scene = asset(geometry, side);
      assert.ok(Math.abs(share(scene) - 1 / 3) < 1e-6, `${share(scene)}`);
      assert.ok(texels(scene, 'asset') < TEXELS);
    }
  }
});

test('the sphere is seen first where a pixel covers less than one texel of the asset', () => {
  const few = asset(new THREE.SphereGeometry(7), 128);
  few.children[0].material.normalMap.wrapS = THREE.RepeatWrapping;
  assert.ok(texels(few, 'asset') < 1);
  assert.equal(firstKind(few, PIXELS), 'sphere');
  for (const side of [2048, undefined]) {
    assert.equal(firstKind(asset(new THREE.SphereGeometry(7), side), PIXELS), 'asset');
  }
  // Maps that do not repeat have still fewer texels on a large sphere.
  const once = asset(new THREE.SphereGeometry(7), 16);
  assert.equal(firstKind(once, PIXELS), 'asset');
});

test('an asset with many texels is whole in the picture', () => {
  const scene = asset(new THREE.BoxGeometry(2, 2, 2), 8192);
  const { distance } = first(scene, 'asset', PIXELS);
  const radius = subject(scene, 'asset').userData.size.length() / 2;
  assert.ok(Math.abs(Math.sin(THREE.MathUtils.degToRad(15)) - radius / distance) < 1e-6);
  assert.ok(texels(scene, 'asset') > TEXELS);
});

test('maps repeat on planes and spheres until a pixel covers the wanted texels', () => {
  for (const kind of ['plane', 'sphere']) {
    for (const side of [16, 1024]) {
      const scene = asset(new THREE.BoxGeometry(), side);
      scene.children[0].material.normalMap.wrapS = THREE.RepeatWrapping;
      assert.ok(Math.abs(texels(scene, kind) - TEXELS) < 1e-6, `${kind} ${side}: ${texels(scene, kind)}`);
    }
    assert.equal(first(asset(new THREE.BoxGeometry()), kind, PIXELS).repeats, undefined);
  }
});
