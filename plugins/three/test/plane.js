// A plane that a camera sees.
import { transform } from './extension_texture.js';
import { cross, dot, normalised, sum } from './vectors.js';

/** Returns a vector of the mesh in the world. */
const placed = ({ node }, vector) => vector.map((value, i) => value * node[i]);

/**
 * Returns the surface of a plane: its normal n, its tangent space T and B for a textureInfo, and the lengths of p_u and
 * p_v ("Frames").
 */
export function surface(plane, info) {
  const { u, v, normal, tangent, node } = plane;
  const n = normalised(normal.map((value, i) => value / node[i]));
  const [[uu, uv], [vu, vv]] = transform(info).matrix;
  const determinant = uu * vv - uv * vu;
  const derivatives = [
    sum([u, vv / determinant], [v, -vu / determinant]),
    sum([u, -uv / determinant], [v, uu / determinant]),
  ];
  const lengths = derivatives.map((derivative) => Math.hypot(...derivative));
  if (tangent) {
    const t = normalised(placed(plane, tangent.slice(0, 3)));
    return { n, t, b: sum([cross(n, t), tangent[3]]), lengths, node };
  }
  const [p_u, p_v] = derivatives.map((derivative) => placed(plane, derivative));
  const gradient = (other, towards) => {
    const across = normalised(cross(other, n));
    return across.map((value) => value * Math.sign(dot(across, towards)));
  };
  const [t, b] = [gradient(p_v, p_u), gradient(p_u, sum([p_v, -1]))];
  return { n, t, b, lengths, node };
}

/** Returns the direction from a camera to a point of its picture, from [0, 0] at the lower left to [1, 1]. */
export function ray({ eye, target, field }, [x, y]) {
  const forward = normalised(sum([target, 1], [eye, -1]));
  const right = normalised(cross(forward, [0, 1, 0]));
  const half = Math.tan((field * Math.PI) / 360);
  return normalised(sum([forward, 1], [right, half * (2 * x - 1)], [cross(right, forward), half * (2 * y - 1)]));
}

/** Returns the texture coordinates, before transforms, where a ray meets a plane. */
export function met(plane, eye, direction) {
  const [corner, p_u, p_v] = [plane.corner, plane.u, plane.v].map((vector) => placed(plane, vector));
  const normal = cross(p_u, p_v);
  const from = sum([corner, 1], [eye, -1]);
  const along = sum([direction, dot(from, normal) / dot(direction, normal)], [from, -1]);
  return [cross(along, p_v), cross(p_u, along)].map((area) => dot(area, normal) / dot(normal, normal));
}
