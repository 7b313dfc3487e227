//! Offsets from tangent-space normals, and back.

use std::iter::repeat;

use rayon::prelude::*;

use super::{MAX_SLOPE, Offset, Outliers};
use crate::bump::Moments;
use crate::bump::normal_map::NormalMap;
use crate::math::symmetric::Symmetric2;
use crate::mip::Rows;
use crate::simd::map_row_marking;

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
    slopes([x, y, z])
}

/// [`offset_from_normal`] without its bound on slopes, of a normal with z > 0.
#[inline(always)]
pub(crate) fn slopes([x, y, z]: [f32; 3]) -> Offset {
    Offset { u: -x / z, v: -y / z }
}

/// The unit normal of an offset: (-f_u, -f_v, 1) normalised.
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

    /// Covariance that rounding to the map's depth alone gives to slopes where the surface is flat: components are off by
    /// up to half a step, evenly, and step^2 / 12 is the variance of that.
    pub fn noise(&self) -> Symmetric2 {
        let step = self.map.step();
        let variance = step * step / 12.0;
        Symmetric2::diagonal(variance, variance)
    }

    /// How many texels are steeper than [`MAX_SLOPE`] or point below the surface.
    pub fn outliers(&self) -> Outliers {
        (0..self.map.height())
            .into_par_iter()
            .map_init(
                || vec![[0.0; 3]; self.map.width() as usize],
                |normals, y| {
                    self.map.row(y, normals);
                    // Most rows have none, which vectors find out.
                    let mut nothing = vec![(); normals.len()];
                    let mark = |normal| ([], is_steep(normal));
                    if !map_row_marking(normals.iter().copied(), &mut nothing, mark, |(), []| ()) {
                        return Outliers::default();
                    }
                    let below = normals.iter().filter(|normal| normal[2] <= 0.0).count() as u64;
                    let steep = normals.iter().filter(|normal| is_steep(**normal)).count() as u64;
                    Outliers { steep: steep - below, below }
                },
            )
            .reduce(Outliers::default, Outliers::plus)
    }

    /// Writes f_u and f_v of row `y` to `out`.
    pub fn offsets(&self, y: u32, out: &mut [[f32; 2]]) {
        self.map_offsets(y, repeat(0.0), out, |Offset { u, v }, _| [u, v], |texel, offset| *texel = offset);
    }

    /// Stores in each of `out` what `of` makes of the texel's offset in row `y` and of the number `beside` it, as
    /// [`map_row`](crate::simd::map_row) does.
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

impl Rows for NormalOffsets<'_> {
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
mod tests {
    use super::*;
    use crate::bump::normal_map::NormalLayout;
    use crate::image::{Image, Samples};

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
    fn rows_hold_what_single_normals_would() {
        let normals = [[0.0, -0.1, 1.0], [1.0, 0.0, 0.05], [0.6, 0.0, -0.8], [0.0, 0.0, 0.0], [0.3, 0.4, 0.5]];
        let image = Image { width: 5, height: 1, channels: 3, samples: Samples::F32(normals.concat()) };
        let map = NormalMap::new(image, NormalLayout::Xyz, false).unwrap();
        let mut row = [Moments::default(); 5];
        NormalOffsets::new(&map).row(0, &mut row);
        assert_eq!(row, normals.map(|normal| Moments::flat(offset_from_normal(normal))));
    }

    #[test]
    fn numbers_stay_beside_their_texels_where_some_are_steep() {
        let normal = |i: u32| if i % 50 == 49 { [1.0, 0.0, 0.01] } else { [0.01 * i as f32, -0.1, 1.0] };
        let samples = Samples::F32((0..150).flat_map(normal).collect());
        let image = Image { width: 150, height: 1, channels: 3, samples };
        let map = NormalMap::new(image, NormalLayout::Xyz, false).unwrap();
        let mut row = [[0.0; 2]; 150];
        let beside = (0..150).map(|i| i as f32);
        let of = |Offset { u, .. }: Offset, beside| [u, beside];
        NormalOffsets::new(&map).map_offsets(0, beside, &mut row, of, |texel, made| *texel = made);
        for (i, texel) in (0..).zip(row) {
            assert_eq!(texel, [offset_from_normal(normal(i)).u, i as f32]);
        }
    }

    #[test]
    fn outliers_are_counted() {
        let normals = [[0.0, -0.1, 1.0], [1.0, 0.0, 0.05], [0.6, 0.0, -0.8], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0625]];
        let image = Image { width: 5, height: 1, channels: 3, samples: Samples::F32(normals.concat()) };
        let map = NormalMap::new(image, NormalLayout::Xyz, false).unwrap();
        assert_eq!(NormalOffsets::new(&map).outliers(), Outliers { steep: 1, below: 2 });
    }

    /// A dome whose slopes cross many steps, in 8 bits: what it differs by from the exact one.
    #[test]
    fn noise_is_what_rounding_makes() {
        let n = 256;
        let exact: Vec<[f32; 3]> = (0..n * n)
            .map(|i| {
                let [x, y] = [i % n, i / n].map(|c| 0.2 * (c as f32 / n as f32 - 0.5));
                [x, y, (1.0 - x * x - y * y).sqrt()]
            })
            .collect();
        let bytes = exact.iter().flatten().map(|c| ((0.5 * c + 0.5) * 255.0).round() as u8).collect();
        let image = Image { width: n, height: n, channels: 3, samples: Samples::U8(bytes) };
        let map = NormalMap::new(image, NormalLayout::Xyz, false).unwrap();
        let offsets = NormalOffsets::new(&map);
        let mut row = vec![Moments::default(); n as usize];
        let mut sums = [0.0; 2];
        for (y, exact) in exact.chunks_exact(n as usize).enumerate() {
            offsets.row(y as u32, &mut row);
            for (found, exact) in row.iter().zip(exact) {
                let exact = offset_from_normal(*exact);
                sums[0] += f64::from(found.mean.u - exact.u).powi(2) / f64::from(n * n);
                sums[1] += f64::from(found.mean.v - exact.v).powi(2) / f64::from(n * n);
            }
        }
        let expected = offsets.noise();
        for (found, expected) in sums.into_iter().zip([expected.uu, expected.vv]) {
            assert!((found / f64::from(expected) - 1.0).abs() < 0.1, "{found} {expected}");
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
