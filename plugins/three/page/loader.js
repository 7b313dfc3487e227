// Loads assets from this server or from files that were dropped, and counts their bytes.
import { LoadingManager } from 'three';
import { DRACOLoader } from 'three/addons/loaders/DRACOLoader.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { KTX2Loader } from 'three/addons/loaders/KTX2Loader.js';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';
import { RoughcastPlugin } from 'three-roughcast';
import { textureBytes, texturesOf } from './bytes.js';
import { refusal } from './refusal.js';
import { isMisdrawn } from './variants.js';

/** The decoders of three.js' own package. */
const LIBRARIES = '/three/examples/jsm/libs';
/** Dropped files are found below this path, which no server answers. */
const DROPPED = '/dropped/';

/**
 * @typedef {{ url: string } | { file: string, files: Map<string, File> }} Source
 *   The address of a document, or the path of a dropped document among all files of its drop.
 * @typedef {{ scene: import('three').Object3D, files: number, textures: number, isMisdrawn: boolean }} Asset
 *   `files`: bytes of the files that were read; `textures`: bytes of the textures on the GPU; `isMisdrawn`: three.js
 *   itself draws the lobes of a bake wrongly.
 */

export class Loader {
  #dropped = new Map();
  #drops = 0;
  /** Paths that were asked for. */
  #asked = new Set();
  #missing = [];
  #blobs = [];
  #manager = new LoadingManager();
  #ktx2;
  #draco;

  /** Textures are filtered with up to `anisotropy` samples along the longer axis of a footprint. */
  constructor(renderer, anisotropy = 1) {
    this.anisotropy = Math.min(anisotropy, renderer.capabilities.getMaxAnisotropy());
    this.#manager.setURLModifier((url) => this.#resolve(url));
    this.#ktx2 = new KTX2Loader(this.#manager).setTranscoderPath(`${LIBRARIES}/basis/`).detectSupport(renderer);
    this.#draco = new DRACOLoader(this.#manager).setDecoderPath(`${LIBRARIES}/draco/gltf/`);
  }

  /**
   * Loads an asset. `reflections` gives anisotropic portable bakes the reflections of the plugin.
   *
   * @param {Source} source
   * @returns {Promise<Asset>}
   * @throws Error that names the files that are missing.
   */
  async load(source, { reflections = false } = {}) {
    const url = source.files ? this.#drop(source) : source.url;
    const folder = url.slice(0, url.lastIndexOf('/') + 1);
    const loader = new GLTFLoader(this.#manager)
      .setKTX2Loader(this.#ktx2)
      .setDRACOLoader(this.#draco)
      .setMeshoptDecoder(MeshoptDecoder)
      .register((parser) => new RoughcastPlugin(parser, { reflections }));
    try {
      const { scene, parser } = await loader.loadAsync(url).catch(async (error) => {
        throw this.#missing.length ? this.#absent(url) : ((await this.#refused(url)) ?? error);
      });
      if (this.#missing.length) throw this.#absent(url);
      for (const texture of texturesOf(scene)) texture.anisotropy = this.anisotropy;
      const bytes = { files: await this.#size(folder), textures: textureBytes(scene) };
      return { scene, ...bytes, isMisdrawn: !reflections && isMisdrawn(parser.json) };
    } finally {
      this.#missing = [];
      for (const blob of this.#blobs.splice(0)) URL.revokeObjectURL(blob);
    }
  }

  /** Takes dropped files in, and returns the address of their document. */
  #drop({ file, files }) {
    const root = `${DROPPED}${this.#drops++}/`;
    for (const [path, content] of files) this.#dropped.set(root + path, content);
    // A name may hold characters that end a path.
    return root + file.split('/').map(encodeURIComponent).join('/');
  }

  #resolve(url) {
    if (/^(blob|data):/.test(url)) return url;
    const path = pathOf(url);
    this.#asked.add(path);
    if (!path.startsWith(DROPPED)) return url;
    const file = this.#dropped.get(path);
    if (!file) {
      this.#missing.push(path.replace(/^\/dropped\/\d+\//, ''));
      return 'data:,';
    }
    this.#blobs.push(URL.createObjectURL(file));
    return this.#blobs.at(-1);
  }

  #absent(url) {
    const names = this.#missing.join(', ');
    return new Error(`${nameOf(url)} needs ${names}: drop all its files, or the whole folder`);
  }

  /** Returns the error that the file at an address is no document, or nothing if that is not what is wrong. */
  async #refused(url) {
    const response = await fetch(this.#resolve(url)).catch(() => undefined);
    const reason = response?.ok && refusal(nameOf(url), new Uint8Array(await response.arrayBuffer()));
    return reason ? new Error(`${nameOf(url)}: ${reason}`) : undefined;
  }

  /** Returns the bytes of the files that were read from a folder. */
  async #size(folder) {
    const root = pathOf(folder);
    const paths = [...this.#asked].filter((path) => path.startsWith(root));
    const sizes = paths.map(async (path) => {
      if (this.#dropped.has(path)) return this.#dropped.get(path).size;
      const { headers } = await fetch(path.split('/').map(encodeURIComponent).join('/'), { method: 'HEAD' });
      return Number(headers.get('content-length'));
    });
    return (await Promise.all(sizes)).reduce((sum, size) => sum + size, 0);
  }
}

/** Returns the decoded path of an address, without `.` and `..`. */
const pathOf = (url) => decodeURIComponent(new URL(url, location.origin).pathname);

/** Returns the file name of an address. */
const nameOf = (url) => pathOf(url).split('/').pop();
