//! Three numbers: half-vectors and normals in (T, B, N).

/// A vector in (T, B, N).
pub type Vector = [f64; 3];

#[inline]
pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `v` with length 1; N when it has no length.
pub fn normalised(v: Vector) -> Vector {
    let length = dot(v, v).sqrt();
    if length > 0.0 { v.map(|c| c / length) } else { [0.0, 0.0, 1.0] }
}

/// x t + y b + z n.
pub fn combine([x, y, z]: Vector, [t, b, n]: [Vector; 3]) -> Vector {
    [0, 1, 2].map(|i| x * t[i] + y * b[i] + z * n[i])
}

/// The orthonormal frame of a unit normal: T made perpendicular to it, then B = N x T. A normal along T takes -N for T,
/// as one that leans there does in the limit.
pub fn frame(n: Vector) -> [Vector; 3] {
    let t = [1.0 - n[0] * n[0], -n[0] * n[1], -n[0] * n[2]];
    let t = if dot(t, t) > 1e-24 { normalised(t) } else { [0.0, 0.0, -1.0] };
    [t, cross(n, t), n]
}

/// Perpendicular to both, right-handed.
pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
