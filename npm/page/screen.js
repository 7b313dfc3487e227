// Puts two pictures of linear radiance on the screen, on both sides of a divider.
import * as THREE from 'three';

const FRAGMENT = /* glsl */ `
uniform sampler2D left, right;
uniform float leftSamples, rightSamples, split, line;
varying vec2 at;
void main() {
  vec4 picture = at.x < split ? texture2D( left, at ) / leftSamples : texture2D( right, at ) / rightSamples;
  // Pixels that nothing covers are transparent.
  vec3 c = picture.rgb + ( 1.0 - picture.a ) * vec3( 0.02, 0.02, 0.022 );
  c *= 1.6 / ( 1.0 + max( max( c.r, c.g ), c.b ) );
  c = sRGBTransferOETF( vec4( c, 1.0 ) ).rgb;
  gl_FragColor = vec4( abs( at.x - split ) < line ? vec3( 1.0 ) : c, 1.0 );
}`;

const UNIFORMS = ['left', 'leftSamples', 'right', 'rightSamples', 'split', 'line'];

export class Screen {
  #material = new THREE.ShaderMaterial({
    uniforms: Object.fromEntries(UNIFORMS.map((name) => [name, { value: null }])),
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

  /** Shows two pictures, each a texture and the number of samples of its sum. `split` is in [0, 1]. */
  show(left, right, split) {
    const { uniforms } = this.#material;
    const values = [left.texture, Math.max(left.samples, 1), right.texture, Math.max(right.samples, 1)];
    // A line two pixels wide.
    [...values, split, 1 / this.renderer.domElement.width].forEach((value, i) => {
      uniforms[UNIFORMS[i]].value = value;
    });
    this.renderer.setRenderTarget(null);
    this.renderer.render(this.#quad, this.#camera);
  }
}
