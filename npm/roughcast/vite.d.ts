import type { Plugin } from 'vite';

import type { Settings } from './index.js';

/**
 * Makes a plugin for Vite that bakes the assets which modules import with `?roughcast`.
 *
 * `import url from './helmet.glb?roughcast'` is the address of a .glb that holds all of its textures. TypeScript knows
 * such modules by `declare module '*?roughcast' { const url: string; export default url; }` in a .d.ts file.
 *
 * @param settings Settings of all bakes.
 */
export function roughcast(settings?: Settings): Plugin;
