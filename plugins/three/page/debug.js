// A switch in every material for what is shown, and from which level.
import { ShaderChunk } from 'three';

/** Quantities that a pixel can show. */
export const VIEWS = ['shaded', 'normal', 'alpha', 'anisotropy'];

/**
 * Shared by all materials: `view` is an index into VIEWS, `level` a mip level, or -1 for what the sampler chooses.
 * `finer` is how many times smaller than pixels the samples are that are drawn.
 */
export const switches = { view: { value: 0 }, level: { value: -1 }, finer: { value: 1 } };

const SAMPLING = /* glsl */ `
uniform int debugView;
uniform float debugLevel;
vec4 debugTexture( sampler2D map, vec2 uv ) {
  return debugLevel < 0.0 ? texture( map, uv ) : textureLod( map, uv, debugLevel );
}
#undef texture2D
#define texture2D debugTexture
uniform float debugFiner;
`;

/** three.js roughens materials by the curvature of the mesh within a pixel. Finer samples keep that roughness. */
const LOBE = ShaderChunk.lights_physical_fragment.replace(
  'float geometryRoughness = ',
  'float geometryRoughness = debugFiner * ',
);

const OUTPUT = /* glsl */ `
#include <opaque_fragment>
#ifdef STANDARD
  if ( debugView == 1 ) gl_FragColor.rgb = 0.5 + 0.5 * normal;
  #ifdef USE_ANISOTROPY
    float debugAlong = material.alphaT;
    vec3 debugT = normalize( tbn[ 0 ] ), debugB = normalize( tbn[ 1 ] );
    vec2 debugAxis = vec2( dot( material.anisotropyT, debugT ), dot( material.anisotropyT, debugB ) );
    // An axis has no sign, so its doubled angle is shown.
    vec2 debugDouble = vec2( debugAxis.x * debugAxis.x - debugAxis.y * debugAxis.y, 2.0 * debugAxis.x * debugAxis.y );
    float debugStrength = material.anisotropy;
  #else
    float debugAlong = pow2( material.roughness ), debugStrength = 0.0;
    vec2 debugDouble = vec2( 0.0 );
  #endif
  if ( debugView == 2 ) gl_FragColor.rgb = vec3( debugAlong, pow2( material.roughness ), pow2( material.roughness ) );
  if ( debugView == 3 ) gl_FragColor.rgb = vec3( 0.5 + 0.5 * debugStrength * debugDouble, debugStrength );
#endif
`;

/** Adds the switch to `material`, once. */
export function debuggable(material) {
  if (material.isDebuggable || !material.isMeshStandardMaterial) return;
  const { onBeforeCompile, customProgramCacheKey } = material;
  const key = customProgramCacheKey.call(material);
  material.isDebuggable = true;
  material.onBeforeCompile = function (program, renderer) {
    onBeforeCompile.call(this, program, renderer);
    Object.assign(program.uniforms, {
      debugView: switches.view,
      debugLevel: switches.level,
      debugFiner: switches.finer,
    });
    const fragment = program.fragmentShader
      .replace('#include <opaque_fragment>', OUTPUT)
      .replace('#include <lights_physical_fragment>', LOBE);
    program.fragmentShader = SAMPLING + fragment;
  };
  material.customProgramCacheKey = () => `debug ${key}`;
  material.needsUpdate = true;
}
