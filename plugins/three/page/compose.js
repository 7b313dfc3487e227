// Shows pictures of linear radiance on the screen, side by side or on both sides of a divider.
import * as THREE from 'three';

const FRAGMENT = /* glsl */ `
uniform sampler2D picture, truth;
uniform float pictureSamples, truthSamples;
uniform int view;
varying vec2 at;

// A colour map from black over purple and orange to white, of rising luminance.
vec3 ramp( float x ) {
  float blue = x < 0.35 ? 1.6 * x : 0.56 - 1.6 * ( x - 0.35 ) + 3.5 * max( x - 0.7, 0.0 );
  return clamp( vec3( 2.2 * x, 2.2 * x - 0.75, blue ), 0.0, 1.0 );
}
vec3 tone( vec3 c ) { return c / ( 1.0 + max( max( c.r, c.g ), c.b ) ); }

void main() {
  vec4 p = texture2D( picture, at ) / pictureSamples, t = texture2D( truth, at ) / truthSamples;
  vec3 c = p.rgb;
  if ( view == 0 ) c = sRGBTransferOETF( vec4( 1.6 * tone( c ), 1.0 ) ).rgb;
  if ( view == 4 ) {
    vec3 off = abs( tone( p.rgb ) - tone( t.rgb ) );
    c = ramp( sqrt( max( max( off.r, off.g ), off.b ) ) );
  }
  gl_FragColor = vec4( c, 1.0 );
}`;

/** Draws pictures to the screen. */
export class Composer {
  #material = new THREE.ShaderMaterial({
    uniforms: Object.fromEntries(
      ['picture', 'pictureSamples', 'truth', 'truthSamples', 'view'].map((name) => [name, { value: null }]),
    ),
    vertexShader: 'varying vec2 at; void main() { at = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }',
    fragmentShader: FRAGMENT,
    depthTest: false,
    toneMapped: false,
  });
  #quad = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), this.#material);
  #camera = new THREE.Camera();

  constructor(renderer) {
    this.renderer = renderer;
    this.#quad.frustumCulled = false;
  }

  /**
   * Draws a picture into `box` [x, y, width, height] of the screen, clipped by `window`. Pictures are sums of samples.
   */
  draw(picture, truth, view, box, window = box) {
    const { uniforms } = this.#material;
    uniforms.picture.value = picture.texture;
    uniforms.pictureSamples.value = Math.max(picture.samples, 1);
    uniforms.truth.value = truth.texture;
    uniforms.truthSamples.value = Math.max(truth.samples, 1);
    uniforms.view.value = view;
    const { renderer } = this;
    renderer.setRenderTarget(null);
    renderer.setViewport(...box);
    renderer.setScissor(...window);
    renderer.setScissorTest(true);
    renderer.render(this.#quad, this.#camera);
    renderer.setScissorTest(false);
  }
}
