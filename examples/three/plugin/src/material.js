import { Vector2, Vector3 } from 'three';
import * as shader from './shader.js';

/** Where the patch goes into the chunks of meshphysical.glsl.js. */
const PLACES = {
  vertex: '#include <begin_vertex>',
  normal: '#include <normal_fragment_maps>',
  lobe: '#include <lights_physical_fragment>',
  functions: '#include <lights_physical_pars_fragment>',
  reflection: '#include <lights_fragment_maps>',
};

/**
 * Makes `material` shade with the pyramid. See index.d.ts.
 *
 * The offset map takes the slot of the normal map, the roughness map that of the bump map, which a normal map silences.
 */
export function applyPyramid(material, pyramid) {
  if (!material.isMeshStandardMaterial) {
    throw new TypeError(`applyPyramid: expected a MeshStandardMaterial or MeshPhysicalMaterial, found ${material.type}`);
  }
  const { offset, roughness } = pyramid;
  const variant = { model: roughness?.model ?? 'none', frame: pyramid.frame };
  const uniforms = {
    roughcastOffsetMin: { value: new Vector2(...offset.min) },
    roughcastOffsetMax: { value: new Vector2(...offset.max) },
    roughcastRoughnessMin: { value: vector3(roughness?.min) },
    roughcastRoughnessMax: { value: vector3(roughness?.max) },
    roughcastCorrection: { value: pyramid.correctionFactor },
    roughcastMain: { value: vector3(pyramid.mainDirection) },
  };
  material.normalMap = offset.map;
  // Ranges hold the normal texture's own scale; the sign of B stays three.js' business.
  material.normalScale.set(1, 1);
  material.bumpMap = roughness?.map ?? null;

  const { onBeforeCompile, customProgramCacheKey, clone } = material;
  const key = customProgramCacheKey.call(material);
  material.onBeforeCompile = function (program, renderer) {
    onBeforeCompile.call(this, program, renderer);
    Object.assign(program.uniforms, uniforms);
    program.vertexShader =
      shader.vertexDeclarations(variant) + after(program.vertexShader, PLACES.vertex, shader.vertexBody(variant));
    let fragment = replaced(program.fragmentShader, PLACES.normal, shader.normal);
    fragment = after(fragment, PLACES.functions, shader.surroundings);
    fragment = after(fragment, PLACES.lobe, shader.fold);
    program.fragmentShader = shader.declarations(variant) + replaced(fragment, PLACES.reflection, shader.reflection);
  };
  material.customProgramCacheKey = () => `roughcast ${variant.model} ${variant.frame} ${key}`;
  // GLTFLoader clones materials for meshes without tangents, and Material.copy leaves hooks behind.
  material.clone = function () {
    const copy = clone.call(this);
    copy.onBeforeCompile = onBeforeCompile;
    copy.customProgramCacheKey = customProgramCacheKey;
    const scale = copy.normalScale.clone();
    applyPyramid(copy, pyramid).normalScale.copy(scale);
    return copy;
  };
  material.needsUpdate = true;
  return material;
}

function vector3(values) {
  return new Vector3(...(values ?? []));
}

function after(source, place, addition) {
  return replaced(source, place, `${place}\n${addition}`);
}

/** Loud where another version of three.js has moved its chunks. */
function replaced(source, place, replacement) {
  if (!source.includes(place)) {
    throw new Error(`three-roughcast: expected ${place} in the shader, found none: this version of three.js is not supported`);
  }
  return source.replace(place, () => replacement);
}
