export { EXTENSION, readExtension } from './extension.js';
export { applyPyramid, applyReflections } from './material.js';
export { RoughcastPlugin } from './plugin.js';
