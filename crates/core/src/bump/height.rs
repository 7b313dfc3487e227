//! Offsets from heights: central differences that respect the sampler's wrap mode at the seam.

use rayon::prelude::*;

use super::{MAX_SLOPE, Offset, Outliers};
use crate::bump::Moments;
use crate::bump::height_map::HeightMap;
use crate::math::symmetric::Symmetric2;
use crate::mip::{TexelRows, Wrap};

/// The offsets of a height map, row by row.
pub struct HeightOffsets<'a> {
    map: &'a HeightMap,
    slope_per_step: [f32; 2],
    wrap: [Wrap; 2],
}

impl<'a> HeightOffsets<'a> {
    /// Reads offsets from `map`. `slope_per_step` is the slope for a height difference of 1 between neighbouring
    /// texels, across and down. `wrap` is the sampler's wrap mode across and down.
    pub fn new(map: &'a HeightMap, slope_per_step: [f32; 2], wrap: [Wrap; 2]) -> Self {
        // An infinite slope times a height difference of 0 would be NaN.
        let slope_per_step = slope_per_step.map(|s| s.clamp(f32::MIN, f32::MAX));
        Self { map, slope_per_step, wrap }
    }

    /// Returns the covariance of slopes on a flat surface that results from rounding to the map's depth alone. Each of
    /// the two heights of a difference over two texels has the variance step^2 / 12.
    pub fn noise(&self) -> Symmetric2 {
        let step = self.map.step();
        let most = f64::from(MAX_SLOPE * MAX_SLOPE);
        let [uu, vv] = self.slope_per_step.map(|slope| {
            let rounding = f64::from(slope) * f64::from(step);
            (rounding * rounding / 24.0).min(most) as f32
        });
        Symmetric2::diagonal(uu, vv)
    }

    /// Counts the texels that are steeper than [`MAX_SLOPE`].
    pub fn outliers(&self) -> Outliers {
        let steep = (0..self.map.height())
            .into_par_iter()
            .map_init(
                || vec![[0.0; 2]; self.map.width() as usize],
                |slopes, y| {
                    self.slopes(y, slopes);
                    let limit = f64::from(MAX_SLOPE * MAX_SLOPE);
                    slopes.iter().filter(|[u, v]| u * u + v * v > limit).count() as u64
                },
            )
            .sum();
        Outliers { steep, ..Outliers::default() }
    }

    /// Computes slopes across and up in f64, because differences of extreme heights overflow f32.
    fn slopes(&self, y: u32, out: &mut [[f64; 2]]) {
        let (above, below, rows_apart) = self.wrap[1].neighbours(y, self.map.height());
        let mut heights = vec![0.0; 3 * out.len()];
        let (middle, rest) = heights.split_at_mut(out.len());
        let (upper, lower) = rest.split_at_mut(out.len());
        self.map.row(y, middle);
        self.map.row(above, upper);
        self.map.row(below, lower);
        for (x, slope) in out.iter_mut().enumerate() {
            let (left, right, columns_apart) = self.wrap[0].neighbours(x as u32, self.map.width());
            let rise_right = f64::from(middle[right as usize]) - f64::from(middle[left as usize]);
            let rise_up = f64::from(upper[x]) - f64::from(lower[x]);
            *slope = [
                f64::from(self.slope_per_step[0]) * rise_right / f64::from(columns_apart),
                f64::from(self.slope_per_step[1]) * rise_up / f64::from(rows_apart),
            ];
        }
    }

    /// Writes f_u and f_v of row `y` to `out`.
    pub fn offsets(&self, y: u32, out: &mut [[f32; 2]]) {
        let mut slopes = vec![[0.0; 2]; out.len()];
        self.slopes(y, &mut slopes);
        for (texel, [u, v]) in out.iter_mut().zip(slopes) {
            let Offset { u, v } = Offset::clamped(u, v);
            *texel = [u, v];
        }
    }
}

impl TexelRows for HeightOffsets<'_> {
    type Texel = Moments;

    fn width(&self) -> u32 {
        self.map.width()
    }

    fn height(&self) -> u32 {
        self.map.height()
    }

    fn row(&self, y: u32, out: &mut [Moments]) {
        let mut offsets = vec![[0.0; 2]; out.len()];
        self.offsets(y, &mut offsets);
        out.iter_mut().zip(offsets).for_each(|(texel, [u, v])| *texel = Moments::flat(Offset { u, v }));
    }
}

#[cfg(test)]
mod tests;
