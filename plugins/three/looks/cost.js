// Runs in the browser: compiles three.js' programs for each way to shade and counts their operations and fetches.
import * as THREE from 'three';
import { RoomEnvironment } from 'three/addons/environments/RoomEnvironment.js';
import { applyPyramid, applyReflections } from 'three-roughcast';
import { count, forSpirv } from '/looks/spirv.js';

const renderer = new THREE.WebGLRenderer();
const texture = () =>
  Object.assign(new THREE.DataTexture(Uint8Array.of(128, 128, 255, 255), 1, 1), { needsUpdate: true });
const maps = () => ({ metalness: 1, normalMap: texture(), roughnessMap: texture(), metalnessMap: texture() });
const plain = (more) => new THREE.MeshPhysicalMaterial({ ...maps(), ...more });

const pyramid = (model, channels) =>
  applyPyramid(plain(), {
    offset: { map: texture(), channels: 3, scale: [1, 1] },
    roughness: { model, map: texture(), min: Array(channels).fill(0), max: Array(channels).fill(1) },
    correctionFactor: 1,
    frame: 'unit',
    mainDirection: null,
  });

const anisotropic = () => plain({ anisotropy: 1, anisotropyMap: texture() });

const MATERIALS = {
  'plain mips, and portable where it is isotropic': () => plain(),
  'portable, anisotropic': anisotropic,
  'the same, reflected': () => applyReflections(anisotropic()),
  'pyramid, lambda_1': () => pyramid('standardDeviation', 1),
  'pyramid, D': () => pyramid('covarianceFactor', 3),
};

/** Returns [[name, operations, fetches], ...]. */
window.costs = async () => {
  const compiler = await glslang('/@babylonjs/core/assets/glslang/glslang.wasm');
  const environment = new THREE.PMREMGenerator(renderer).fromScene(new RoomEnvironment()).texture;
  const geometry = new THREE.PlaneGeometry();
  geometry.computeTangents();
  return Object.entries(MATERIALS).map(([name, make]) => {
    const known = new Set(renderer.info.programs);
    const scene = new THREE.Scene().add(new THREE.Mesh(geometry, make()), new THREE.DirectionalLight());
    scene.environment = environment;
    renderer.render(scene, new THREE.PerspectiveCamera());
    const [made] = renderer.info.programs.filter((program) => !known.has(program));
    const source = renderer.getContext().getShaderSource(made.fragmentShader);
    const { operations, fetches } = count(compiler.compileGLSL(forSpirv(source), 'fragment'));
    return [name, operations, fetches];
  });
};
window.ready = true;
