//! Offsets from tangent-space normals, and back.

use std::iter::repeat;

use rayon::prelude::*;

use super::{MAX_SLOPE, Offset, Outliers};
use crate::bump::Moments;
use crate::bump::normal_map::NormalMap;
use crate::math::symmetric::Symmetric2;
use crate::mip::TexelRows;
use crate::simd::map_row_marking;

/// Computes f_u = -x/z, f_v = -y/z. The length of the normal cancels, so that maps need not be normalised.
///
/// Slopes beyond [`MAX_SLOPE`] and normals that point below the surface (z <= 0) keep their direction and get the slope
/// [`MAX_SLOPE`]. A vector without x and y is flat.
pub fn offset_from_normal([x, y, z]: [f32; 3]) -> Offset {
    if is_steep([x, y, z]) {
        // Scales the vector beyond the limit, so that the clamp sets the slope exactly to the limit.
        let (x, y) = (f64::from(x), f64::from(y));
        let longest = x.abs().max(y.abs());
        let scale = if longest > 0.0 { -2.0 * f64::from(MAX_SLOPE) / longest } else { 0.0 };
        return Offset::clamped(x * scale, y * scale);
    }
    slopes([x, y, z])
}

/// Computes [`offset_from_normal`] without its bound on slopes, for a normal with z > 0.
#[inline(always)]
pub(crate) fn slopes([x, y, z]: [f32; 3]) -> Offset {
    Offset { u: -x / z, v: -y / z }
}

/// Returns the unit normal of an offset: (-f_u, -f_v, 1) normalised.
#[inline(always)]
pub fn normal_from_offset(offset: Offset) -> [f32; 3] {
    let scale = 1.0 / (offset.u * offset.u + offset.v * offset.v + 1.0).sqrt();
    [-offset.u * scale, -offset.v * scale, scale]
}

#[inline(always)]
fn is_steep([x, y, z]: [f32; 3]) -> bool {
    (z <= 0.0) | (x * x + y * y > MAX_SLOPE * MAX_SLOPE * z * z)
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

    /// Returns the covariance of slopes on a flat surface that results from rounding to the map's depth alone. Rounding
    /// errors are uniform within half a step, and their variance is step^2 / 12.
    pub fn noise(&self) -> Symmetric2 {
        let step = self.map.step();
        let variance = step * step / 12.0;
        Symmetric2::diagonal(variance, variance)
    }

    /// Counts the texels that are steeper than [`MAX_SLOPE`], point below the surface, or hold no normal.
    pub fn outliers(&self) -> Outliers {
        let outliers = (0..self.map.height())
            .into_par_iter()
            .map_init(
                || vec![[0.0; 3]; self.map.width() as usize],
                |normals, y| {
                    self.map.row(y, normals);
                    // Most rows have no such texel, which vector code finds out quickly.
                    let mut nothing = vec![(); normals.len()];
                    let mark = |normal| ([], is_steep(normal));
                    if !map_row_marking(normals.iter().copied(), &mut nothing, mark, |(), []| ()) {
                        return Outliers::default();
                    }
                    let below = normals.iter().filter(|normal| normal[2] <= 0.0).count() as u64;
                    let steep = normals.iter().filter(|normal| is_steep(**normal)).count() as u64;
                    Outliers { steep: steep - below, below, unused: 0 }
                },
            )
            .reduce(Outliers::default, Outliers::plus);
        Outliers { unused: self.map.unused(), ..outliers }
    }

    /// Writes f_u and f_v of row `y` to `out`.
    pub fn offsets(&self, y: u32, out: &mut [[f32; 2]]) {
        self.map_offsets(y, repeat(0.0), out, |Offset { u, v }, _| [u, v], |texel, offset| *texel = offset);
    }

    /// Applies `of` to the offset of every texel of row `y` and to its number in `beside`, and stores the results in
    /// `out`, as [`map_row`](crate::simd::map_row) does.
    pub(crate) fn map_offsets<T, const M: usize>(
        &self,
        y: u32,
        beside: impl Iterator<Item = f32> + Clone,
        out: &mut [T],
        of: impl Fn(Offset, f32) -> [f32; M],
        store: impl Fn(&mut T, [f32; M]),
    ) {
        let mut normals = vec![[0.0; 3]; out.len()];
        self.map.row(y, &mut normals);
        let is_any_steep = map_row_marking(
            normals.iter().zip(beside.clone()).map(|(&[x, y, z], beside)| [x, y, z, beside]),
            out,
            |[x, y, z, beside]| (of(slopes([x, y, z]), beside), is_steep([x, y, z])),
            &store,
        );
        if is_any_steep {
            let texels = out.iter_mut().zip(normals).zip(beside).filter(|((_, normal), _)| is_steep(*normal));
            texels.for_each(|((texel, normal), beside)| store(texel, of(offset_from_normal(normal), beside)));
        }
    }
}

impl TexelRows for NormalOffsets<'_> {
    type Texel = Moments;

    fn width(&self) -> u32 {
        self.map.width()
    }

    fn height(&self) -> u32 {
        self.map.height()
    }

    fn row(&self, y: u32, out: &mut [Moments]) {
        let flat = |texel: &mut Moments, [u, v]: [f32; 2]| *texel = Moments::flat(Offset { u, v });
        self.map_offsets(y, repeat(0.0), out, |Offset { u, v }, _| [u, v], flat);
    }
}

#[cfg(test)]
mod tests;
