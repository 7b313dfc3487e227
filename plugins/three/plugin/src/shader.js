// GLSL that the patch inserts into three.js' standard and physical shaders. The offset map has the slot of the normal
// map, and the roughness map has the slot of the bump map, so three.js itself computes texture coordinates and
// transforms of both.

/** Goes first in the fragment shader: definitions and uniforms. */
export const declarations = ({ model, frame, channels }) => /* glsl */ `
#define ROUGHCAST_FRAME_${frame === 'mainDirection' ? 'MAIN' : frame.toUpperCase()}
${model === 'covarianceFactor' ? '#define ROUGHCAST_FACTOR' : ''}
${model === 'standardDeviation' ? '#define ROUGHCAST_DEVIATION' : ''}
${channels === 2 ? '#define ROUGHCAST_REBUILT_Z' : ''}
#if defined( ROUGHCAST_FACTOR ) && ! defined( USE_ANISOTROPY )
  // D needs the anisotropic lobe. The base lobe of a material without anisotropy is isotropic.
  #define USE_ANISOTROPY
#endif
uniform vec2 roughcastOffsetScale;
uniform vec3 roughcastRoughnessMin;
uniform vec3 roughcastRoughnessMax;
uniform float roughcastCorrection;
#ifdef ROUGHCAST_FRAME_NATURAL
  varying vec3 vRoughcastPosition;
#endif
#ifdef ROUGHCAST_FRAME_MAIN
  varying vec4 vRoughcastMain;
#endif
`;

/** Goes first in the vertex shader. */
export const vertexDeclarations = ({ frame }) =>
  ({
    unit: '',
    natural: 'varying vec3 vRoughcastPosition;\n',
    mainDirection: 'varying vec4 vRoughcastMain;\nuniform vec3 roughcastMain;\n',
  })[frame];

/** Goes after `#include <begin_vertex>`. */
export const vertexBody = ({ frame }) =>
  ({
    unit: '',
    natural: /* glsl */ `
  vRoughcastPosition = position;`,
    mainDirection: /* glsl */ `
  mat3 roughcastToView = mat3( modelViewMatrix );
  #ifdef USE_INSTANCING
    roughcastToView *= mat3( instanceMatrix );
  #endif
  // w is -1 where the node mirrors the mesh, which mirrors e1 as well.
  vRoughcastMain = vec4( roughcastToView * roughcastMain, sign( determinant( roughcastToView ) ) );`,
  })[frame];

/** Replaces `#include <normal_fragment_maps>`: n' = n - f_u e1 - f_v e2. */
export const normal = /* glsl */ `
  vec3 roughcastE1, roughcastE2;
  // The scale of the slopes in the map. normalScale includes the sign of B: three.js flips it where a mesh has no
  // tangents, since B from derivatives points down the image.
  vec2 roughcastScale = normalScale;
  {
    roughcastE1 = normalize( tbn[ 0 ] );
    roughcastE2 = normalize( tbn[ 1 ] );
    #ifdef ROUGHCAST_FRAME_MAIN
      // e1 = m x n, e2 = n x e1: the part of m along the surface. Where n is parallel to m, that part is 0.
      vec3 alongSurface = vRoughcastMain.xyz - dot( vRoughcastMain.xyz, normal ) * normal;
      if ( length( alongSurface ) > 1e-4 * length( vRoughcastMain.xyz ) ) {
        roughcastE2 = normalize( alongSurface );
        roughcastE1 = vRoughcastMain.w * cross( roughcastE2, normal );
        #ifdef DOUBLE_SIDED
          // On back faces three.js has flipped the normal, and e1 with it.
          roughcastE2 *= faceDirection;
        #endif
        roughcastScale = abs( normalScale );
      }
    #endif
    #ifdef ROUGHCAST_FRAME_NATURAL
      // |p_u| and |p_v|, in units of the mesh per repeat.
      vec3 px = dFdx( vRoughcastPosition ), py = dFdy( vRoughcastPosition );
      vec2 tx = dFdx( vNormalMapUv ), ty = dFdy( vNormalMapUv );
      float det = tx.x * ty.y - ty.x * tx.y;
      vec2 stretch = vec2( length( px * ty.y - py * tx.y ), length( py * tx.x - px * ty.x ) );
      roughcastScale *= abs( det ) / max( stretch, vec2( 1e-20 ) );
    #endif
    // Unit normals of offsets that are divided by their scale.
    vec3 stored = 2.0 * texture2D( normalMap, vNormalMapUv ).xyz - 1.0;
    #ifdef ROUGHCAST_REBUILT_Z
      stored.z = sqrt( max( 1.0 - dot( stored.xy, stored.xy ), 0.0 ) );
    #endif
    vec2 f = - roughcastScale * roughcastOffsetScale * stored.xy / max( stored.z, 1.0 / 32.0 );
    normal = normalize( normal - f.x * roughcastE1 - f.y * roughcastE2 );
  }
`;

/**
 * Goes before `BRDF_GGX` in `lights_physical_pars_fragment`: the term of visibility of the lobe. Smith's term is that
 * of facets that hide each other. Bumps of a map do not, so that each of them has the term of the base lobe.
 */
export const visibility = /* glsl */ `
// The alphas of the base lobe along T and B, and the shares of the bumps in the squared alphas of the lobe.
vec2 roughcastAlphas, roughcastShares;
float roughcastVisibility( vec3 l, vec3 v, vec3 n, vec3 h, PhysicalMaterial material ) {
  // g is the normal of one bump, which stands for all bumps that reflect l to v.
  float dotNH = dot( n, h );
  vec3 slope = ( h - dotNH * n ) / max( dotNH, 1e-4 );
  vec2 gain = roughcastShares * roughcastShares;
  #ifdef USE_ANISOTROPY
    vec3 t = material.anisotropyT, b = material.anisotropyB;
    vec3 g = normalize( n + gain.x * dot( slope, t ) * t + gain.y * dot( slope, b ) * b );
  #else
    vec3 g = normalize( n + gain.x * slope );
  #endif
  float dotGL = saturate( dot( g, l ) ), dotGV = saturate( dot( g, v ) );
  #ifdef USE_ANISOTROPY
    t = normalize( t - dot( t, g ) * g );
    b = cross( g, t );
    float term = V_GGX_SmithCorrelated_Anisotropic(
      roughcastAlphas.x, roughcastAlphas.y, dot( t, v ), dot( b, v ), dot( t, l ), dot( b, l ), dotGV, dotGL );
  #else
    float term = V_GGX_SmithCorrelated( roughcastAlphas.x, dotGL, dotGV );
  #endif
  return term * dot( n, g ) * dotGL / max( dot( n, l ), 1e-4 );
}
#define V_GGX_SmithCorrelated_Anisotropic( at, ab, tv, bv, tl, bl, nv, nl ) \
  roughcastVisibility( lightDir, viewDir, normal, halfDir, material )
#define V_GGX_SmithCorrelated( alpha, nl, nv ) roughcastVisibility( lightDir, viewDir, normal, halfDir, material )
`;

/** Goes after `#include <lights_physical_pars_fragment>`: the environment as an anisotropic lobe reflects it. */
export const surroundings = /* glsl */ `
#if defined( USE_ANISOTROPY ) && defined( USE_ENVMAP )
  // Adds what a facet reflects, with the albedo of the base lobe at its own angle, and its albedo.
  void roughcastReflect(
    vec3 view, vec3 facet, float base, float roughness,
    inout PhysicalMaterial material, inout vec3 sum, inout vec3 albedos
  ) {
    vec2 dfg = texture2D( dfgLUT, vec2( base, saturate( dot( facet, view ) ) ) ).rg;
    vec3 albedo = material.specularColorBlended * dfg.x + material.specularF90 * dfg.y;
    sum += albedo * getIBLRadiance( view, facet, roughness );
    albedos += albedo;
    material.dfg += dfg;
  }

  // Averages what facets reflect, each with the roughness of the base lobe. Facets are weighted by their area in the
  // map and do not hide each other, as in an unfiltered map. three.js' single look-up along a bent normal is far too
  // bright on spheres. Weights by the visible area of real facets (B. Walter et al., 2007, eq. 41) are too bright on
  // planes. three.js multiplies the result by the mean albedo, so that the sum is divided by the albedos here.
  vec3 roughcastRadiance( vec3 view, vec3 n, float base, inout PhysicalMaterial material ) {
    const int PAIRS = 8;
    // Pi over the golden ratio: directions and their opposites cover the circle evenly.
    const float ANGLE = 1.94161104;
    // Slopes with the covariance S / 2 make Beckmann's lobe with the squared alphas S, and slopes with 0.82 S make that
    // of GGX, by likelihood. Facets here have 0.65 S, which lies between them: WIDTH / 2.
    const float WIDTH = 1.3;
    // The spread of the facets is S = A' - alpha_b^2 1, which is 2 c K for an isotropic base lobe. A quarter of the
    // smaller spread is left to blur, since there are few facets.
    vec2 spread = max( vec2( pow2( material.alphaT ), pow4( material.roughness ) ) - pow4( base ), 0.0 );
    float blur = 0.25 * spread.y;
    spread = sqrt( WIDTH * max( spread - blur, 0.0 ) );
    float roughness = sqrt( sqrt( pow4( base ) + blur ) );
    vec3 sum = vec3( 0.0 ), albedos = vec3( 0.0 );
    material.dfg = vec2( 0.0 );
    for ( int i = 0; i < PAIRS; i ++ ) {
      // Slopes at quantiles of a normal distribution, on a spiral, each with the opposite slope: their mean is 0, and
      // the signs of the axes do not matter.
      float radius = sqrt( - log( 1.0 - ( float( i ) + 0.5 ) / float( PAIRS ) ) ), angle = ANGLE * float( i );
      vec2 slope = radius * spread * vec2( cos( angle ), sin( angle ) );
      vec3 tilt = slope.x * material.anisotropyT + slope.y * material.anisotropyB;
      roughcastReflect( view, normalize( n + tilt ), base, roughness, material, sum, albedos );
      roughcastReflect( view, normalize( n - tilt ), base, roughness, material, sum, albedos );
    }
    material.dfg /= float( 2 * PAIRS );
    return sum / max( albedos, vec3( 1e-6 ) );
  }
#endif
`;

/**
 * Goes after `#include <lights_physical_fragment>` of a material without a pyramid: makes axes perpendicular to the
 * normal.
 */
export const axes = /* glsl */ `
float roughcastBase = material.roughness;
#ifdef USE_ANISOTROPY
  // three.js keeps the axes in the surface. Lobes about tilted normals are then not normalised, and too bright.
  material.anisotropyT = normalize( material.anisotropyT - dot( material.anisotropyT, normal ) * normal );
  material.anisotropyB = cross( normal, material.anisotropyT );
#endif
`;

/** Wraps `#include <lights_fragment_maps>`: replaces three.js' look-up of the environment. */
export const reflection = /* glsl */ `
#if defined( USE_ANISOTROPY ) && defined( USE_ENVMAP )
  #define getIBLAnisotropyRadiance( view, n, roughness, b, strength ) \
    roughcastRadiance( view, n, roughcastBase, material )
#endif
#include <lights_fragment_maps>
#undef getIBLAnisotropyRadiance
`;

/**
 * Goes after `#include <lights_fragment_maps>`: diffuse light is the mean over the normals of the bumps. The part of
 * the irradiance that changes sign with the normal counts by the length of the mean normal. Direct light is that part
 * alone, where no bump is in shadow.
 */
export const diffuse = /* glsl */ `
#if defined( ROUGHCAST_FACTOR ) || defined( ROUGHCAST_DEVIATION )
  reflectedLight.directDiffuse *= roughcastMeanNormal;
  #ifdef USE_ENVMAP
    vec3 roughcastEven = 0.5 * ( iblIrradiance + getIBLIrradiance( - geometryNormal ) );
    iblIrradiance = mix( roughcastEven, iblIrradiance, roughcastMeanNormal );
  #endif
#endif
`;

/** The arguments, in `lights_fragment_begin`, of the light that facets lose to and regain from each other. */
export const LOST_LIGHT = 'vec2( material.roughness, dotNVms )';
/** Bumps of a map neither hide nor light each other, so the base lobe alone decides on that light. */
export const baseLostLight = 'vec2( roughcastBase, dotNVms )';

/** Goes after `#include <lights_physical_fragment>`: roughens the lobe, A' = A + 2 c K. */
export const roughen = /* glsl */ `
  float roughcastBase = material.roughness;
  roughcastAlphas = vec2( pow2( material.roughness ) );
  roughcastShares = vec2( 0.0 );
  #if defined( ROUGHCAST_FACTOR ) || defined( ROUGHCAST_DEVIATION )
    // D or lambda_1, filtered by the sampler.
    vec3 roughcastD = mix( roughcastRoughnessMin, roughcastRoughnessMax, texture2D( bumpMap, vBumpMapUv ).rgb );
    #ifdef ROUGHCAST_FACTOR
      // K = D D^T with D = [[d1, d2], [0, d3]].
      vec3 roughcastK = vec3( dot( roughcastD.xy, roughcastD.xy ), roughcastD.y * roughcastD.z, pow2( roughcastD.z ) );
    #else
      vec3 roughcastK = vec3( pow2( roughcastD.x ), 0.0, pow2( roughcastD.x ) );
    #endif
    roughcastK *= roughcastScale.xxy * roughcastScale.xyy;
    // The length of the mean of the unit normals of the bumps, whose slopes have the variance c tr K.
    float roughcastMeanNormal = inversesqrt( 1.0 + roughcastCorrection * ( roughcastK.x + roughcastK.z ) );
  #else
    const vec3 roughcastK = vec3( 0.0 );
  #endif
  #ifdef USE_ANISOTROPY
  {
    // The base lobe, in the frame of K. Without tangents, the B of three.js points down the image, and the shorter of
    // its T and B is not normalised.
    float across = pow2( pow2( material.roughness ) ), along = pow2( material.alphaT );
    vec3 t = anisotropyV.x * normalize( tbn[ 0 ] ) + sign( normalScale.y ) * anisotropyV.y * normalize( tbn[ 1 ] );
    vec2 axis = vec2( dot( t, roughcastE1 ), dot( t, roughcastE2 ) );
    axis /= max( length( axis ), 1e-6 );
    vec3 base = vec3( across, 0.0, across ) + ( along - across ) * axis.xxy * axis.xyy;
    vec3 bumps = 2.0 * roughcastCorrection * roughcastK;
    vec3 a = base + bumps;
    // Eigenvalues, and the axis of the larger one.
    float mean = 0.5 * ( a.x + a.z ), difference = 0.5 * ( a.x - a.z ), radius = length( vec2( difference, a.y ) );
    float major = min( mean + radius, 1.0 ), minor = clamp( mean - radius, across, 1.0 );
    vec2 e = difference > 0.0 ? vec2( radius + difference, a.y ) : vec2( a.y, radius - difference );
    float size = length( e );
    e = size > 1e-9 ? e / size : axis;
    material.alphaT = sqrt( major );
    float alphaB = sqrt( minor );
    material.roughness = sqrt( alphaB );
    // The strength that gives these alphas in KHR_materials_anisotropy.
    material.anisotropy = sqrt( saturate( ( material.alphaT - alphaB ) / max( 1.0 - alphaB, 1e-6 ) ) );
    t = e.x * roughcastE1 + e.y * roughcastE2;
    material.anisotropyT = normalize( t - dot( t, normal ) * normal );
    material.anisotropyB = cross( normal, material.anisotropyT );
    // Base lobe and bumps along the axes of the lobe.
    vec3 square = vec3( e.x * e.x, 2.0 * e.x * e.y, e.y * e.y );
    float baseT = dot( base, square ), bumpsT = dot( bumps, square );
    vec2 squares = max( vec2( baseT, base.x + base.z - baseT ), across );
    vec2 bumpSquares = max( vec2( bumpsT, bumps.x + bumps.z - bumpsT ), 0.0 );
    roughcastAlphas = sqrt( squares );
    roughcastShares = bumpSquares / ( squares + bumpSquares );
  }
  #elif defined( ROUGHCAST_DEVIATION )
    // Different scales of u and v make the lobe anisotropic. This shader has isotropic lobes only, so it takes the
    // mean.
    float bumps = roughcastCorrection * ( roughcastK.x + roughcastK.z );
    float squared = pow4( material.roughness ) + bumps;
    roughcastShares = vec2( bumps / squared );
    material.roughness = sqrt( sqrt( min( squared, 1.0 ) ) );
  #endif
`;
