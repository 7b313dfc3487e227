//! Offsets from tangent-space normals, and back.

use rayon::prelude::*;

use super::{MAX_SLOPE, Offset};
use crate::map::NormalMap;
use crate::pyramid::{Moments, Rows};

/// f_u = -x/z, f_v = -y/z: the length of the normal cancels, so maps need not be normalised. Slopes beyond
/// [`MAX_SLOPE`], and normals that point below the surface (z <= 0), keep their direction and get that slope; a vector
/// without direction is flat.
pub fn offset_from_normal([x, y, z]: [f32; 3]) -> Offset {
    if is_steep([x, y, z]) {
        // A multiple that is steeper still, for the clamp to cut.
        let (x, y) = (f64::from(x), f64::from(y));
        let longest = x.abs().max(y.abs());
        let scale = if longest > 0.0 { -2.0 * f64::from(MAX_SLOPE) / longest } else { 0.0 };
        return Offset::clamped(x * scale, y * scale);
    }
    Offset { u: -x / z, v: -y / z }
}

/// The unit normal of an offset: (-f_u, -f_v, 1) normalised.
pub fn normal_from_offset(offset: Offset) -> [f32; 3] {
    let scale = 1.0 / (offset.u * offset.u + offset.v * offset.v + 1.0).sqrt();
    [-offset.u * scale, -offset.v * scale, scale]
}

fn is_steep([x, y, z]: [f32; 3]) -> bool {
    z <= 0.0 || x * x + y * y > MAX_SLOPE * MAX_SLOPE * z * z
}

/// The offsets of a normal map, row by row.
pub struct NormalOffsets<'a> {
    map: &'a NormalMap,
}

impl<'a> NormalOffsets<'a> {
    /// Reads offsets from `map`.
    pub fn new(map: &'a NormalMap) -> Self {
        Self { map }
    }

    /// How many texels are steeper than [`MAX_SLOPE`] or point below the surface.
    pub fn steep_texels(&self) -> u64 {
        (0..self.map.height())
            .into_par_iter()
            .map_init(
                || vec![[0.0; 3]; self.map.width() as usize],
                |normals, y| {
                    self.map.row(y, normals);
                    normals.iter().filter(|n| is_steep(**n)).count() as u64
                },
            )
            .sum()
    }
}

impl Rows for NormalOffsets<'_> {
    type Texel = Moments;

    fn width(&self) -> u32 {
        self.map.width()
    }

    fn height(&self) -> u32 {
        self.map.height()
    }

    fn row(&self, y: u32, out: &mut [Moments]) {
        let mut normals = vec![[0.0; 3]; out.len()];
        self.map.row(y, &mut normals);
        for (texel, normal) in out.iter_mut().zip(normals) {
            *texel = Moments::flat(offset_from_normal(normal));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_of_hand_computed_normals() {
        let offset = offset_from_normal([0.6, 0.0, 0.8]);
        assert!((offset.u + 0.75).abs() < 1e-6 && offset.v == 0.0);
        // Length cancels.
        assert_eq!(offset_from_normal([1.2, -0.4, 1.6]), offset_from_normal([0.6, -0.2, 0.8]));
    }

    #[test]
    fn steep_and_backward_normals_keep_their_direction() {
        for normal in [[1.0, 0.0, 0.001], [1.0, 0.0, 0.0], [1.0, 0.0, -1.0]] {
            assert_eq!(offset_from_normal(normal), Offset { u: -MAX_SLOPE, v: 0.0 });
        }
        for normal in [[0.0, 0.0, 0.0], [0.0, 0.0, -1.0]] {
            assert_eq!(offset_from_normal(normal), Offset::default());
        }
    }

    #[test]
    fn normal_and_offset_are_inverse() {
        for normal in [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [-0.48, 0.64, 0.6]] {
            let back = normal_from_offset(offset_from_normal(normal));
            for (a, b) in normal.iter().zip(back) {
                assert!((a - b).abs() < 1e-6);
            }
        }
    }
}
