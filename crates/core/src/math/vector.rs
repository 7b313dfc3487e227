//! Three-dimensional vectors: half-vectors and normals in (T, B, N).

use std::ops::{Add, Mul, Sub};

/// A vector in (T, B, N).
pub type Vector = [f64; 3];

/// Returns the dot product of two vectors.
#[inline(always)]
pub fn dot<F: Copy + Add<Output = F> + Mul<Output = F>>(a: [F; 3], b: [F; 3]) -> F {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Returns `v` scaled to length 1, or N if `v` is 0.
#[inline]
pub fn normalised(v: Vector) -> Vector {
    let length = dot(v, v).sqrt();
    if length > 0.0 { v.map(|c| c / length) } else { [0.0, 0.0, 1.0] }
}

/// Returns x t + y b + z n.
#[inline]
pub fn combine([x, y, z]: Vector, [t, b, n]: [Vector; 3]) -> Vector {
    [0, 1, 2].map(|i| x * t[i] + y * b[i] + z * n[i])
}

/// Returns the orthonormal frame of a unit normal: T made perpendicular to the normal, then B = N x T. For a normal
/// along T, the first vector is -N, which is the limit for normals that approach T.
#[inline]
pub fn frame(n: Vector) -> [Vector; 3] {
    let t = [1.0 - n[0] * n[0], -n[0] * n[1], -n[0] * n[2]];
    let t = if dot(t, t) > 1e-24 { normalised(t) } else { [0.0, 0.0, -1.0] };
    [t, cross(n, t), n]
}

/// Returns the right-handed cross product.
#[inline(always)]
pub fn cross<F: Copy + Mul<Output = F> + Sub<Output = F>>(a: [F; 3], b: [F; 3]) -> [F; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
