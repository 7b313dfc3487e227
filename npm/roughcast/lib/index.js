// The library `roughcast`. `index.d.ts` and `bake.d.ts` describe it.
export { bake, bakeMap } from './bake.js';
export { Pyramid, RoughnessPyramid } from './roughness-pyramid.js';
export { roughcast } from './transform.js';
