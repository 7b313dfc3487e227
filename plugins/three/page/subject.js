// The subject: the asset itself, or a plane or a sphere with the first material that has bumps.
import * as THREE from 'three';

/** Repeats of the maps on a plane and around a sphere. */
const REPEATS = { plane: 8, sphere: 6 };

/** Makes a mesh with glTF's tangents: v points down the image, and B points up. */
function withTangents(geometry, repeats) {
  const uv = geometry.attributes.uv;
  for (let i = 0; i < uv.count; i++) uv.setXY(i, uv.getX(i) * repeats, (1 - uv.getY(i)) * repeats);
  geometry.computeTangents();
  // three.js takes B along +v.
  const tangent = geometry.attributes.tangent;
  for (let i = 0; i < tangent.count; i++) tangent.setW(i, -tangent.getW(i));
  return geometry;
}

const GEOMETRIES = {
  plane: () => new THREE.PlaneGeometry(4, 4, 8, 8).rotateX(-Math.PI / 2),
  sphere: () => new THREE.SphereGeometry(1, 96, 48),
};

/** Makes a plane or a sphere with a material. Maps that do not repeat are shown once. */
function sample(kind, material, repeats) {
  const isClamped = material.normalMap?.wrapS === THREE.ClampToEdgeWrapping;
  return new THREE.Mesh(withTangents(GEOMETRIES[kind](), isClamped ? 1 : repeats), tangential(material));
}

/** Returns the first material with bumps, else the first material. */
export function bumpy(scene) {
  const materials = [];
  scene.traverse((object) => object.isMesh && materials.push(object.material));
  return materials.find((material) => material.normalMap) ?? materials[0];
}

/**
 * @param {THREE.Object3D} scene What a loader returned.
 * @param {'asset' | 'plane' | 'sphere'} kind
 * @param {number} [repeats] Repeats of the maps on a plane or around a sphere.
 * @returns {THREE.Object3D} centred, about 2 units large, with its size along each axis in `userData.size`
 */
export function subject(scene, kind, repeats = REPEATS[kind]) {
  const object = kind === 'asset' ? scene.clone() : sample(kind, bumpy(scene), repeats);
  const box = new THREE.Box3().setFromObject(object);
  const size = box.getSize(new THREE.Vector3());
  const group = new THREE.Group().add(object);
  const scale = kind === 'asset' ? 2.4 / (size.length() || 1) : 1;
  group.scale.setScalar(scale);
  group.position.copy(box.getCenter(new THREE.Vector3())).multiplyScalar(-scale);
  group.userData.size = size.multiplyScalar(scale);
  return group;
}

/** Undoes a flip: GLTFLoader flips B of materials whose mesh has no tangents, and these meshes have tangents. */
function tangential(material) {
  if (material.normalScale?.y >= 0) return material;
  const copy = material.clone();
  copy.normalScale.y *= -1;
  return copy;
}
