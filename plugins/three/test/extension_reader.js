// Shading by ROUGHCAST_materials_roughness_pyramid as docs/extension/README.md describes it, written from that page
// alone. It shares no code with the plugin, so that a test can hold the page against what the tool writes.

import { clamp, cross, dot, normalised, sum } from './vectors.js';

export const EXTENSION = 'ROUGHCAST_materials_roughness_pyramid';

/** Returns the slopes of a filtered texel of the offset texture ("From texel to slopes"). */
export function slopes({ offsetChannels, offsetScale }, texel) {
  const [x, y, stored] = texel.map((value) => 2 * value - 1);
  const z = offsetChannels === 2 ? Math.sqrt(Math.max(1 - x * x - y * y, 0)) : stored;
  return [x, y].map((value, i) => (offsetScale[i] * -value) / Math.max(z, 1 / 32));
}

/** Returns K as [uu, uv, vv] of a filtered texel of the roughness texture ("From texel to K"). */
export function covariance({ roughnessModel, roughnessMin: min, roughnessMax: max }, texel) {
  if (roughnessModel === undefined) return [0, 0, 0];
  const [d1, d2, d3] = min.map((low, i) => low + texel[i] * (max[i] - low));
  if (roughnessModel === 'standardDeviation') return [d1 * d1, 0, d1 * d1];
  return [d1 * d1 + d2 * d2, d2 * d3, d3 * d3];
}

/**
 * Returns the axes and the scale of slopes and K ("Frames") on a surface with unit normal n, tangent space T and B, and
 * derivatives of the position by the texture coordinates of lengths |p_u| and |p_v|. `node` is the scale of the node,
 * one factor for each axis.
 */
export function frame({ frame: name, mainDirection }, { n, t, b, lengths, node = [1, 1, 1] }) {
  const m = name === 'mainDirection' ? mainDirection.map((value, i) => value * node[i]) : [0, 0, 0];
  const along = sum([m, 1], [n, -dot(m, n)]);
  if (Math.hypot(...along) > 1e-4 * Math.hypot(...m)) {
    const e2 = normalised(along);
    const isMirrored = node[0] * node[1] * node[2] < 0;
    return { e1: isMirrored ? cross(n, e2) : cross(e2, n), e2, n, scale: [1, 1] };
  }
  const scale = name === 'natural' ? lengths.map((length) => 1 / length) : [1, 1];
  return { e1: normalised(t), e2: normalised(b), n, scale };
}

/** Returns n' ("The normal") of slopes in a frame. */
export function normal({ e1, e2, n, scale }, [f_u, f_v]) {
  return normalised(n.map((value, i) => value - scale[0] * f_u * e1[i] - scale[1] * f_v * e2[i]));
}

/** Returns K along the axes of a frame: K multiplied by the scale from both sides. */
export const scaledCovariance = ({ scale: [s1, s2] }, [uu, uv, vv]) => [s1 * s1 * uu, s1 * s2 * uv, s2 * s2 * vv];

/** Returns A as [uu, uv, vv] of the base lobe ("The lobe"): roughness, strength and direction in (e1, e2). */
export function baseLobe(roughness, strength = 0, direction = [1, 0]) {
  const across = roughness ** 2;
  const along = across + (1 - across) * strength ** 2;
  const [a1, a2] = normalised(direction);
  const more = along ** 2 - across ** 2;
  return [across ** 2 + more * a1 * a1, more * a1 * a2, across ** 2 + more * a2 * a2];
}

/** Returns A' ("The lobe"). */
export const roughened = ({ correctionFactor }, base, k) => base.map((value, i) => value + 2 * correctionFactor * k[i]);

/** Returns the parameters with which KHR_materials_anisotropy shades A'. `least` is the square of alpha_b of A. */
export function parameters([uu, uv, vv], least) {
  const [m, d] = [(uu + vv) / 2, (uu - vv) / 2];
  const q = Math.hypot(d, uv);
  const eigenvalues = [Math.min(m + q, 1), clamp(m - q, least, 1)];
  const axis = d > 0 ? [q + d, uv] : [uv, q - d];
  const [alphaT, alphaB] = eigenvalues.map(Math.sqrt);
  return {
    eigenvalues,
    axis: dot(axis, axis) > 0 ? normalised(axis) : [1, 0],
    alphas: [alphaT, alphaB],
    roughness: Math.sqrt(alphaB),
    strength: alphaB < 1 ? Math.sqrt((alphaT - alphaB) / (1 - alphaB)) : 0,
  };
}

/** Returns L, the length of the mean normal of the bumps ("Lights"), of K along the axes of the frame. */
export const meanNormal = ({ correctionFactor }, [uu, , vv]) => 1 / Math.sqrt(1 + correctionFactor * (uu + vv));

/** Returns the axes t' and n' x t' of a lobe ("The lobe") about the normal n', from its axis in a frame. */
export function axes({ e1, e2 }, normal, [along1, along2]) {
  const t = sum([e1, along1], [e2, along2]);
  const tangent = normalised(sum([t, 1], [normal, -dot(t, normal)]));
  return [tangent, cross(normal, tangent)];
}

/** Returns what is lit on the back of a double-sided material ("Frames"): n' and the axis t' are negated. */
export function behind({ normal, axes: [t], ...lit }) {
  const [n, tangent] = [normal, t].map((vector) => vector.map((value) => -value));
  return { ...lit, normal: n, axes: [tangent, cross(n, tangent)] };
}

/**
 * Returns the look-ups of an environment for a lobe ("Environments"): normals, and the roughness of all of them.
 * `method` is the number of look-ups, the share of the smaller spread that is left to blur, and a factor on the rest.
 */
export function lookUps({ normal, axes: [t, b], alphas, baseRoughness }, method) {
  const base = baseRoughness ** 4;
  const spread = alphas.map((alpha) => Math.max(alpha ** 2 - base, 0));
  const blur = method.blur * spread[1];
  const [along, across] = spread.map((value) => Math.sqrt(method.spread * (value - blur)));
  const pairs = method.count / 2;
  const normals = Array.from({ length: pairs }, (_, i) => {
    const radius = Math.sqrt(-Math.log(1 - (i + 0.5) / pairs));
    const [x, y] = [along * radius * Math.cos(1.94161104 * i), across * radius * Math.sin(1.94161104 * i)];
    return [1, -1].map((sign) => normalised(sum([normal, 1], [t, sign * x], [b, sign * y])));
  });
  return { normals: normals.flat(), roughness: (base + blur) ** 0.25 };
}

/** Returns the one look-up of an environment that a loader may use: n', and the roughness of equal determinant. */
export const lookUp = ({ normal, alphas: [alphaT, alphaB] }) => ({
  normals: [normal],
  roughness: (alphaT * alphaB) ** 0.25,
});

/**
 * Returns a_t and a_b, the alphas of the base lobe along the axes of the roughened lobe, and P_t and P_b, the shares of
 * the bumps ("Lights").
 */
export function parts({ correctionFactor }, base, k, [e1, e2]) {
  const along = ([uu, uv, vv]) => uu * e1 * e1 + 2 * uv * e1 * e2 + vv * e2 * e2;
  const both = (matrix) => [along(matrix), matrix[0] + matrix[2] - along(matrix)];
  const [squares, bumps] = [both(base), both(k).map((value) => 2 * correctionFactor * value)];
  return { baseAlphas: squares.map(Math.sqrt), shares: bumps.map((bump, i) => bump / (squares[i] + bump)) };
}

/** Returns g, the normal of the bump that reflects light along the half-vector h ("Lights"). */
function bump({ normal: n, axes, shares }, h) {
  const slopes = axes.map((axis) => dot(axis, h) / Math.max(dot(n, h), 1e-4));
  return normalised(sum([n, 1], ...axes.map((axis, i) => [axis, shares[i] ** 2 * slopes[i]])));
}

/** Returns the distribution of a lobe at the half-vector h ("Lights"). */
function distribution({ normal: n, axes: [t, b], alphas: [alphaT, alphaB] }, h) {
  const stretched = Math.hypot(dot(t, h) / alphaT, dot(b, h) / alphaB, Math.max(dot(n, h), 0));
  return 1 / (Math.PI * alphaT * alphaB * stretched ** 4);
}

/** Returns the masking term times C_i (n' . g) ("Lights"), for the directions to the eye and to the light. */
export function masking(lit, eye, light) {
  const g = bump(lit, normalised(sum([eye, 1], [light, 1])));
  const [alphaT, alphaB] = lit.baseAlphas;
  const t = normalised(sum([lit.axes[0], 1], [g, -dot(lit.axes[0], g)]));
  const b = cross(g, t);
  const [towardsEye, towardsLight] = [eye, light].map((direction) => Math.max(dot(g, direction), 0));
  if (towardsLight === 0) return 0;
  const length = (w, cosine) => Math.hypot(alphaT * dot(t, w), alphaB * dot(b, w), cosine);
  const sides = towardsLight * length(eye, towardsEye) + towardsEye * length(light, towardsLight);
  return (towardsLight * dot(lit.normal, g)) / (2 * sides);
}

/**
 * Returns the specular lobe without Fresnel's factor, times its cosine with the light ("Lights"), for the directions to
 * the eye and to the light.
 */
export function specular(lit, eye, light) {
  if (dot(lit.normal, light) <= 0) return 0;
  return distribution(lit, normalised(sum([eye, 1], [light, 1]))) * masking(lit, eye, light);
}
