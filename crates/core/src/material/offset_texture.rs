//! The offset texture of the pyramid profile: the unit normals of scaled offsets.
//!
//! Offsets in a range from the smallest to the largest slope would lose their precision to a few steep texels: 1 % of
//! texels with slopes of 16 leave a step of 0.13 to all others. `benches/studies/pyramid_coding.rs` compares codes.

use rayon::prelude::*;

use crate::bump::{Offset, normal_from_offset};
use crate::material::mip_chain::Encoding;
use crate::material::product::Product;
use crate::material::pyramid_levels::{PyramidLevels, PyramidTexel};
use crate::material::stored_slopes::Steepness;

/// The least z that readers assume. Steeper slopes are those of this z: 32 times the scale.
pub const LEAST_Z: f64 = 1.0 / 32.0;

/// The texture of the offsets of all levels: x, y, z in [0, 1], with 1/2 for 0. Offsets are
/// (f_u, f_v) = scale (-x/z, -y/z).
pub struct OffsetTexture<'l> {
    levels: &'l dyn PyramidLevels,
    /// Multiplies the slopes of the normals.
    pub scale: f32,
}

impl<'l> OffsetTexture<'l> {
    /// Chooses the scale for the levels that `encoding` writes. Floats need no scale, unless a PNG holds level 0, too.
    pub fn new(levels: &'l dyn PyramidLevels, encoding: Encoding) -> Self {
        let is_exact = !encoding.format.is_normalised() && !encoding.fallback;
        let scale = if is_exact { 1.0 } else { steepness(levels, encoding.first(&levels.sizes())).scale() };
        Self { levels, scale }
    }
}

impl Product for OffsetTexture<'_> {
    fn sizes(&self) -> Vec<(u32, u32)> {
        self.levels.sizes()
    }

    fn row(&self, level: usize, y: u32, out: &mut [[f32; 4]]) {
        let mut texels = vec![PyramidTexel::default(); out.len()];
        self.levels.row(level, y, &mut texels);
        let inverse = 1.0 / self.scale;
        for (value, PyramidTexel { offset, .. }) in out.iter_mut().zip(texels) {
            let [x, y, z] = normal_from_offset(Offset { u: inverse * offset.u, v: inverse * offset.v });
            *value = [0.5 * x + 0.5, 0.5 * y + 0.5, 0.5 * z + 0.5, 1.0];
        }
    }
}

/// Returns the slopes of a texel x, y, z in [0, 1], which the scale multiplies.
pub fn slopes_of_texel(texel: [f64; 3]) -> [f64; 2] {
    let [x, y, z] = texel.map(|c| 2.0 * c - 1.0);
    let z = z.max(LEAST_Z);
    [-x / z, -y / z]
}

/// Returns how steep the offsets of all levels from `first` on are.
fn steepness(levels: &dyn PyramidLevels, first: usize) -> Steepness {
    let mut steepness = Steepness::default();
    for (level, (width, height)) in levels.sizes().into_iter().enumerate().skip(first) {
        let of_row = |texels: &mut Vec<PyramidTexel>, y| {
            levels.row(level, y, texels);
            let mut steepness = Steepness::default();
            steepness.add(texels.iter().map(|texel| texel.offset));
            steepness
        };
        let empty = || vec![PyramidTexel::default(); width as usize];
        // Rows are added in order, so that the sum does not depend on the number of threads.
        let rows: Vec<Steepness> = (0..height).into_par_iter().map_init(empty, of_row).collect();
        let mut level = Steepness::default();
        rows.into_iter().for_each(|row| level.merge(row));
        steepness.merge(level);
    }
    steepness
}

#[cfg(test)]
mod tests;
