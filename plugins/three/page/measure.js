// The error of a picture, summed on the GPU.
import * as THREE from 'three';

/** Side of the blocks of pixels that one fragment sums. */
const BLOCK = 16;

const FRAGMENT = /* glsl */ `
uniform sampler2D picture, truth;
uniform float pictureSamples, truthSamples;
out vec4 sums;

void main() {
  ivec2 size = textureSize( truth, 0 ), first = ${BLOCK} * ivec2( gl_FragCoord.xy );
  sums = vec4( 0.0 );
  for ( int y = 0; y < ${BLOCK}; y ++ ) {
    for ( int x = 0; x < ${BLOCK}; x ++ ) {
      ivec2 at = first + ivec2( x, y );
      if ( any( greaterThanEqual( at, size ) ) ) continue;
      vec4 t = texelFetch( truth, at, 0 ) / truthSamples;
      // Edges of the subject: their error is that of multisampling, which is the same in all variants.
      if ( t.a < 0.999 ) continue;
      vec3 p = texelFetch( picture, at, 0 ).rgb / pictureSamples, off = abs( p - t.rgb );
      sums += vec4( off.r + off.g + off.b, t.r + t.g + t.b, 1.0, 0.0 );
    }
  }
}`;

export class Meter {
  #material = new THREE.ShaderMaterial({
    glslVersion: THREE.GLSL3,
    uniforms: Object.fromEntries(
      ['picture', 'pictureSamples', 'truth', 'truthSamples'].map((name) => [name, { value: null }]),
    ),
    vertexShader: 'void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }',
    fragmentShader: FRAGMENT,
    depthTest: false,
    blending: THREE.NoBlending,
  });
  #quad = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), this.#material);
  #camera = new THREE.Camera();
  #sums = new THREE.WebGLRenderTarget(1, 1, { type: THREE.FloatType, depthBuffer: false });

  constructor(renderer) {
    this.renderer = renderer;
    this.#quad.frustumCulled = false;
  }

  /**
   * Returns the relative L1 of linear radiance, the sum of |picture - truth| over the sum of the truth, over the pixels
   * that the subject covers. Pictures are sums of samples. Returns null where nothing is lit.
   */
  relativeL1(picture, truth) {
    const { width, height } = truth.texture.image;
    const [columns, rows] = [width, height].map((side) => Math.ceil(side / BLOCK));
    const { uniforms } = this.#material;
    uniforms.picture.value = picture.texture;
    uniforms.pictureSamples.value = picture.samples;
    uniforms.truth.value = truth.texture;
    uniforms.truthSamples.value = truth.samples;
    this.#sums.setSize(columns, rows);
    this.renderer.setRenderTarget(this.#sums);
    this.renderer.render(this.#quad, this.#camera);
    this.renderer.setRenderTarget(null);
    const sums = new Float32Array(4 * columns * rows);
    this.renderer.readRenderTargetPixels(this.#sums, 0, 0, columns, rows, sums);
    let [off, total] = [0, 0];
    for (let i = 0; i < sums.length; i += 4) [off, total] = [off + sums[i], total + sums[i + 1]];
    return total > 0 ? off / total : null;
  }
}
