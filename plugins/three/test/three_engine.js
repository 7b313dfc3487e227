// What three.js and its GPU compute in their own ways, where the extension and glTF leave it to them.
import { getDFGLUT } from 'three/src/renderers/shaders/DFGLUTData.js';
import { CLAMP_TO_EDGE, bilinear } from './extension_texture.js';
import { fromHalf } from './half_floats.js';

const { data, width, height } = getDFGLUT().image;
const texels = Array.from({ length: width * height }, (_, i) => [...data.slice(2 * i, 2 * i + 2)].map(fromHalf));

export const THREE_JS = {
  /** Returns the weight of 1 in Fresnel's factor, from the cosine of the angle between the eye and the half vector. */
  fresnelWeight: (cosine) => 2 ** ((-5.55473 * cosine - 6.98316) * cosine),
  /** Returns by how much light between microfacets brightens the lobe of a roughness. */
  betweenFacets(f0, roughness, cosine) {
    const [scale, bias] = bilinear({ width, height, texels }, CLAMP_TO_EDGE, [roughness, cosine]);
    return 1 + f0 * (1 / (scale + bias) - 1);
  },
  leastRoughness: 0.045,
  /** Returns the level of detail by straight lines between powers of two, as SwiftShader does. */
  level(squared) {
    const exponent = Math.floor(2 * Math.log2(squared));
    return 0.25 * (exponent + squared ** 2 / 2 ** exponent - 1);
  },
};
