export { EXTENSION, readExtension } from './extension.js';
export { applyPyramid } from './material.js';
export { RoughcastPlugin } from './plugin.js';
