//! The scale of stored slopes: texels hold unit normals of slopes that are divided by a scale, so that low bumps use
//! all values of their texture.

use rayon::prelude::*;

use crate::bump::{Moments, Offset};
use crate::material::bumps::Bumps;
use crate::mip::TexelRows;

/// Ratio of the scale for blocks to the best scale for bytes. Texels of a block differ more where slopes are steep, and
/// a block rounds them by a share of their difference. In UASTC, `benches/studies/pyramid_coding.rs` finds mean lobe
/// errors of 0.214, 0.205 and 0.202 for ratios of 1/2, 1 and 2, 0.248 for a range from the smallest to the largest
/// offset, and 0.161 without encoding.
const BLOCK_WIDENING: f32 = 2.0;

/// Largest scale of a normal texture. Larger scales gain little, and a material is better left as it is.
const LARGEST_NORMAL_SCALE: f32 = 0.5;

/// Most rows of level 0 that decide on the scale of a normal texture.
const MOST_ROWS: u32 = 256;

/// The slope between the bytes 126 and 129 of a source with 8 bits, which are flat but for rounding.
const FLAT: f32 = 1.6 / 127.5;

/// The share of flat texels from which a scale keeps their bytes.
const FLAT_SHARE: f64 = 0.1;

/// Sums over slopes, which decide on a scale.
#[derive(Clone, Copy, Default)]
pub struct Steepness {
    squared_sines: f64,
    count: f64,
    flat: f64,
}

impl Steepness {
    /// Adds slopes.
    pub fn add(&mut self, offsets: impl Iterator<Item = Offset>) {
        for Offset { u, v } in offsets {
            let square = f64::from(u) * f64::from(u) + f64::from(v) * f64::from(v);
            self.squared_sines += square / (1.0 + square);
            self.count += 1.0;
            self.flat += f64::from(u8::from(u.abs().max(v.abs()) < FLAT));
        }
    }

    /// Adds the sums of `other`.
    pub fn merge(&mut self, other: Self) {
        self.squared_sines += other.squared_sines;
        self.count += other.count;
        self.flat += other.flat;
    }

    /// Returns the scale s for blocks: [`BLOCK_WIDENING`] times the best scale for bytes. With many flat texels, it is
    /// a [`byte_scale`] near that.
    pub fn scale(&self) -> f32 {
        let scale = BLOCK_WIDENING * self.best_scale();
        if self.flat >= FLAT_SHARE * self.count { byte_scale(scale) } else { scale }
    }

    /// Returns the scale s for which a rounding error of the stored normals moves the surface's own normals least on
    /// average.
    ///
    /// An error d of the stored direction changes a slope f by (s + f^2 / s) d, and the surface's direction by
    /// 1 / (1 + f^2) of this. The mean is s a + b / s, where a and b are the means of 1 / (1 + f^2) and
    /// f^2 / (1 + f^2): cos^2 and sin^2 of the slope. It is least for s = sqrt(b / a).
    pub(super) fn best_scale(&self) -> f32 {
        let share = self.squared_sines / self.count;
        // Any scale serves a flat map.
        if share > 0.0 { (share / (1.0 - share)).sqrt() as f32 } else { 1.0 }
    }
}

/// Returns the scale 1, 1/3, 1/5, ... whose ratio to `scale` is nearest to 1, or `scale` itself above sqrt(3).
///
/// These scales keep the normals of flat areas as a source with 8 bits has them. A byte i of x or y stands for the
/// slope (i - 127.5) / 127.5 where z is 1, and k times this slope is a byte again if k is odd. With other scales, whole
/// areas of a mirror have one wrong direction: the facade of docs/engines.md has a lobe error of 0.66 at level 0 with a
/// scale of 0.42, and of 0.29 with 1/3. Without flat areas, such a scale only is further from the best one.
pub fn byte_scale(scale: f32) -> f32 {
    let smaller_odd = 2.0 * (0.5 * (1.0 / scale - 1.0)).floor().max(0.0) + 1.0;
    let larger_odd = smaller_odd + 2.0;
    let odd = if scale * scale * smaller_odd * larger_odd > 1.0 { smaller_odd } else { larger_odd };
    if scale * scale > 3.0 { scale } else { 1.0 / odd }
}

/// Returns the scale of the normal texture of `bumps`, which `normalTexture.scale` multiplies: 1 unless the bumps are
/// low.
pub fn normal_scale(bumps: &Bumps<'_>) -> f32 {
    let (rows, (width, height)) = (bumps.rows, bumps.size());
    // An odd step meets all rows of patterns whose size is a power of 2.
    let step = (height / MOST_ROWS) | 1;
    let of_row = |y: u32| {
        let mut row = vec![Moments::default(); width as usize];
        rows.row(y, &mut row);
        let mut steepness = Steepness::default();
        steepness.add(row.iter().map(|moments| moments.mean));
        steepness
    };
    let sums: Vec<Steepness> = (0..height.div_ceil(step)).into_par_iter().map(|i| of_row(i * step)).collect();
    // Rows are added in order, so that the sum does not depend on the number of threads.
    let mut steepness = Steepness::default();
    sums.into_iter().for_each(|sum| steepness.merge(sum));
    let scale = steepness.scale();
    if scale < LARGEST_NORMAL_SCALE { scale } else { 1.0 }
}

#[cfg(test)]
mod tests;
