// The bytes of a .glb to objects of three.js.
import { DRACOLoader } from 'three/addons/loaders/DRACOLoader.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { KTX2Loader } from 'three/addons/loaders/KTX2Loader.js';
import { texturesOf } from './viewer/bytes.js';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';

const libraries = new URL('three/examples/jsm/libs/', import.meta.url).href;

/** Largest anisotropy of the texture filter. */
const ANISOTROPY = 16;

/** Returns a function from the bytes of a .glb to the root of its default scene. */
export function newLoader(renderer) {
  const loader = new GLTFLoader()
    .setKTX2Loader(new KTX2Loader().setTranscoderPath(`${libraries}basis/`).detectSupport(renderer))
    .setDRACOLoader(new DRACOLoader().setDecoderPath(`${libraries}draco/gltf/`))
    .setMeshoptDecoder(MeshoptDecoder);
  const anisotropy = Math.min(ANISOTROPY, renderer.capabilities.getMaxAnisotropy());
  return async (bytes) => {
    // A copy: the loader may keep the buffer, and the bytes are offered for download.
    const { scene } = await loader.parseAsync(bytes.slice().buffer, '');
    for (const texture of texturesOf(scene)) texture.anisotropy = anisotropy;
    return scene;
  };
}
