import { ShaderChunk, Vector2, Vector3 } from 'three';
import * as shader from './shader.js';

/** Lines of meshphysical.glsl.js at which the patch is inserted. */
const ANCHORS = {
  vertex: '#include <begin_vertex>',
  normal: '#include <normal_fragment_maps>',
  lobe: '#include <lights_physical_fragment>',
  functions: '#include <lights_physical_pars_fragment>',
  maps: '#include <lights_fragment_maps>',
  lights: '#include <lights_fragment_begin>',
};

/**
 * Makes `material` shade with the pyramid. See index.d.ts.
 *
 * The offset map takes the slot of the normal map, and the roughness map takes the slot of the bump map. three.js reads
 * no bump map where there is a normal map.
 */
export function applyPyramid(material, pyramid) {
  if (!material.isMeshStandardMaterial) {
    throw new TypeError(
      `applyPyramid: expected a MeshStandardMaterial or MeshPhysicalMaterial, found ${material.type}`,
    );
  }
  const { offset, roughness } = pyramid;
  const variant = { model: roughness?.model ?? 'none', frame: pyramid.frame, channels: offset.channels };
  const uniforms = {
    roughcastOffsetScale: { value: new Vector2(...offset.scale) },
    roughcastRoughnessMin: { value: vector3(roughness?.min) },
    roughcastRoughnessMax: { value: vector3(roughness?.max) },
    roughcastCorrection: { value: pyramid.correctionFactor },
    roughcastMain: { value: vector3(pyramid.mainDirection) },
  };
  material.normalMap = offset.map;
  // The scale of the offsets includes the scale of the normal texture. three.js itself applies the sign of B.
  material.normalScale.set(1, 1);
  material.bumpMap = roughness?.map ?? null;

  const edit = (program) => {
    Object.assign(program.uniforms, uniforms);
    program.vertexShader =
      shader.vertexDeclarations(variant) + after(program.vertexShader, ANCHORS.vertex, shader.vertexBody(variant));
    const lights = replaced(ShaderChunk.lights_fragment_begin, shader.LOST_LIGHT, shader.baseLostLight);
    const tilted = replaced(program.fragmentShader, ANCHORS.normal, shader.normal);
    const roughened = after(replaced(tilted, ANCHORS.lights, lights), ANCHORS.lobe, shader.roughen);
    const reflecting = after(withReflections(roughened), ANCHORS.maps, shader.diffuse);
    const lit = replaced(reflecting, ANCHORS.functions, withVisibility(ShaderChunk.lights_physical_pars_fragment));
    program.fragmentShader = shader.declarations(variant) + lit;
  };
  return patch(material, `roughcast ${variant.model} ${variant.frame} ${variant.channels}`, edit, (copy) => {
    const scale = copy.normalScale.clone();
    applyPyramid(copy, pyramid).normalScale.copy(scale);
  });
}

/** Makes `material` reflect its surroundings along the ellipse of its lobe. See index.d.ts. */
export function applyReflections(material) {
  if (!material.isMeshStandardMaterial) {
    throw new TypeError(`applyReflections: expected a MeshPhysicalMaterial, found ${material.type}`);
  }
  const edit = (program) =>
    (program.fragmentShader = withReflections(after(program.fragmentShader, ANCHORS.lobe, shader.axes)));
  return patch(material, 'roughcast reflections', edit, applyReflections);
}

/** Hooks `edit`, which changes each program, into a material, and `patchClone` into its clones. */
function patch(material, name, edit, patchClone) {
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
    patchClone(copy);
    return copy;
  };
  material.needsUpdate = true;
  return material;
}

/** Returns the functions of three.js with the term of visibility of bumps that do not hide each other. */
export function withVisibility(functions) {
  const lobe = 'vec3 BRDF_GGX( ';
  return replaced(functions, lobe, shader.visibility + lobe);
}

function withReflections(fragment) {
  return replaced(after(fragment, ANCHORS.functions, shader.surroundings), ANCHORS.maps, shader.reflection);
}

function vector3(values) {
  return new Vector3(...(values ?? []));
}

function after(source, anchor, addition) {
  return replaced(source, anchor, `${anchor}\n${addition}`);
}

/** Replaces `anchor`, and throws where another version of three.js has moved its chunks. */
function replaced(source, anchor, replacement) {
  if (!source.includes(anchor)) {
    throw new Error(
      `three-roughcast: expected ${anchor} in the shader, found none: this version of three.js is not supported`,
    );
  }
  return source.replace(anchor, () => replacement);
}
