import { ShaderChunk, Vector2, Vector3 } from 'three';
import * as shader from './shader.js';

/** Where the patch goes into the chunks of meshphysical.glsl.js. */
const PLACES = {
  vertex: '#include <begin_vertex>',
  normal: '#include <normal_fragment_maps>',
  lobe: '#include <lights_physical_fragment>',
  functions: '#include <lights_physical_pars_fragment>',
  reflection: '#include <lights_fragment_maps>',
  lights: '#include <lights_fragment_begin>',
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

  const edit = (program) => {
    Object.assign(program.uniforms, uniforms);
    program.vertexShader =
      shader.vertexDeclarations(variant) + after(program.vertexShader, PLACES.vertex, shader.vertexBody(variant));
    const lights = replaced(ShaderChunk.lights_fragment_begin, shader.LOST_LIGHT, shader.ownLostLight);
    const tilted = replaced(program.fragmentShader, PLACES.normal, shader.normal);
    const folded = after(replaced(tilted, PLACES.lights, lights), PLACES.lobe, shader.fold);
    program.fragmentShader = shader.declarations(variant) + reflecting(folded);
  };
  return patch(material, `roughcast ${variant.model} ${variant.frame}`, edit, (copy) => {
    const scale = copy.normalScale.clone();
    applyPyramid(copy, pyramid).normalScale.copy(scale);
  });
}

/** Makes `material` reflect the surroundings along its own ellipse. See index.d.ts. */
export function applyReflections(material) {
  if (!material.isMeshStandardMaterial) {
    throw new TypeError(`applyReflections: expected a MeshPhysicalMaterial, found ${material.type}`);
  }
  const edit = (program) => (program.fragmentShader = reflecting(after(program.fragmentShader, PLACES.lobe, shader.axes)));
  return patch(material, 'roughcast reflections', edit, applyReflections);
}

/** `edit` changes each program, `again` patches a clone. */
function patch(material, name, edit, again) {
  const { onBeforeCompile, customProgramCacheKey, clone } = material;
  const key = customProgramCacheKey.call(material);
  material.onBeforeCompile = function (program, renderer) {
    onBeforeCompile.call(this, program, renderer);
    edit(program);
  };
  material.customProgramCacheKey = () => `${name} ${key}`;
  // GLTFLoader clones materials for meshes without tangents, and Material.copy leaves hooks behind.
  material.clone = function () {
    const copy = clone.call(this);
    Object.assign(copy, { onBeforeCompile, customProgramCacheKey });
    again(copy);
    return copy;
  };
  material.needsUpdate = true;
  return material;
}

function reflecting(fragment) {
  return replaced(after(fragment, PLACES.functions, shader.surroundings), PLACES.reflection, shader.reflection);
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
