// Shows pictures of linear radiance on the screen, side by side or on both sides of a divider.
import * as THREE from 'three';
import { RAMP } from './ramp.js';

const FRAGMENT = /* glsl */ `
uniform sampler2D picture, truth;
uniform float pictureSamples, truthSamples;
uniform int view;
uniform float exposure;
uniform vec3 background;
/** The part of the pictures that is shown: lower left corner and size. */
uniform vec4 part;
varying vec2 at;

${RAMP}vec3 tone( vec3 c ) { return c / ( 1.0 + max( max( c.r, c.g ), c.b ) ); }

void main() {
  vec2 from = part.xy + at * part.zw;
  if ( any( lessThan( from, vec2( 0.0 ) ) ) || any( greaterThan( from, vec2( 1.0 ) ) ) ) discard;
  vec4 p = texture2D( picture, from ) / pictureSamples, t = texture2D( truth, from ) / truthSamples;
  vec3 c = p.rgb;
  // Pictures are premultiplied by their coverage.
  if ( view == 0 ) c = exposure * p.rgb + ( 1.0 - p.a ) * background;
  if ( view == 0 ) c = sRGBTransferOETF( vec4( 1.6 * tone( c ), 1.0 ) ).rgb;
  if ( view == 4 ) {
    vec3 off = abs( tone( exposure * p.rgb ) - tone( exposure * t.rgb ) );
    c = ramp( max( max( off.r, off.g ), off.b ) );
  }
  gl_FragColor = vec4( c, 1.0 );
}`;

const UNIFORMS = ['picture', 'pictureSamples', 'truth', 'truthSamples', 'view', 'exposure', 'background', 'part'];

/** Draws pictures to the screen. */
export class Composer {
  #material = new THREE.ShaderMaterial({
    uniforms: Object.fromEntries(UNIFORMS.map((name) => [name, { value: null }])),
    vertexShader: 'varying vec2 at; void main() { at = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }',
    fragmentShader: FRAGMENT,
    depthTest: false,
    toneMapped: false,
  });
  #quad = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), this.#material);
  #camera = new THREE.Camera();

  /** Factor on the radiance. */
  exposure = 1;

  /** `background` is seen where nothing covers a pixel. */
  constructor(renderer, background) {
    this.renderer = renderer;
    this.#material.uniforms.background.value = background;
    this.#material.uniforms.part.value = new THREE.Vector4();
    this.#quad.frustumCulled = false;
  }

  /**
   * Draws a picture into `box` [x, y, width, height] of the screen, clipped by `window`. Pictures are sums of samples.
   * `part` [x, y, width, height], in [0, 1], is magnified to the box.
   */
  draw(picture, truth, view, { box, window = box, part = [0, 0, 1, 1] }) {
    const { uniforms } = this.#material;
    uniforms.picture.value = picture.texture;
    uniforms.pictureSamples.value = picture.samples;
    uniforms.truth.value = truth.texture;
    uniforms.truthSamples.value = truth.samples;
    uniforms.view.value = view;
    uniforms.exposure.value = this.exposure;
    uniforms.part.value.set(...part);
    const { renderer } = this;
    renderer.setRenderTarget(null);
    renderer.setViewport(...box);
    renderer.setScissor(...window);
    renderer.setScissorTest(true);
    renderer.render(this.#quad, this.#camera);
    renderer.setScissorTest(false);
  }
}
