// What three.js and its GPU compute in their own ways, where the extension and glTF leave it to them.
import { getDFGLUT } from 'three/src/renderers/shaders/DFGLUTData.js';
import { CLAMP_TO_EDGE, bilinear } from './extension_texture.js';
import { fromHalf } from './half_floats.js';
import { dot, normalised, sum } from './vectors.js';

const { data, width, height } = getDFGLUT().image;
const texels = Array.from({ length: width * height }, (_, i) => [...data.slice(2 * i, 2 * i + 2)].map(fromHalf));

/** Returns the two numbers of three.js' table of albedos for a roughness and the cosine of an angle. */
const table = (roughness, cosine) => bilinear({ width, height, texels }, CLAMP_TO_EDGE, [roughness, cosine]);

export const THREE_JS = {
  /** Returns the weight of 1 in Fresnel's factor, from the cosine of the angle between the eye and the half vector. */
  fresnelWeight: (cosine) => 2 ** ((-5.55473 * cosine - 6.98316) * cosine),
  /** Returns by how much light between microfacets brightens the lobe of a roughness. */
  betweenFacets(f0, roughness, cosine) {
    const [scale, bias] = table(roughness, cosine);
    return 1 + f0 * (1 / (scale + bias) - 1);
  },
  table,
  /**
   * Returns how much of an environment a lobe reflects at once, and after light between microfacets, from numbers of
   * the table.
   */
  albedos(f0, [scale, bias]) {
    const [once, lost, mean] = [f0 * scale + bias, 1 - scale - bias, f0 + (1 - f0) / 21];
    return [once, (once * mean * lost) / (1 - lost * mean)];
  },
  /**
   * Returns where three.js looks an isotropic reflection up: a direction, and the level as a share of the last level.
   */
  reflected(eye, normal, roughness) {
    const mirrored = sum([normal, 2 * dot(normal, eye)], [eye, -1]);
    const share = roughness ** 4;
    return [...normalised(sum([mirrored, 1 - share], [normal, share])), roughness * (2 - roughness)];
  },
  leastRoughness: 0.045,
  /** Returns the level of detail by straight lines between powers of two, as SwiftShader does. */
  level(squared) {
    const exponent = Math.floor(2 * Math.log2(squared));
    return 0.25 * (exponent + squared ** 2 / 2 ** exponent - 1);
  },
};
