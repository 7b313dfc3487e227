//! Offsets from heights: central differences that respect the sampler's wrap mode at the seam.

use rayon::prelude::*;

use super::{MAX_SLOPE, Offset, Outliers};
use crate::bump::Moments;
use crate::bump::height_map::HeightMap;
use crate::math::symmetric::Symmetric2;
use crate::mip::{Rows, Wrap};

/// The offsets of a height map, row by row.
pub struct HeightOffsets<'a> {
    map: &'a HeightMap,
    slope_per_step: [f32; 2],
    wrap: [Wrap; 2],
}

impl<'a> HeightOffsets<'a> {
    /// Reads offsets from `map`. `slope_per_step` is the slope where the height changes by 1 between neighbouring texels,
    /// across and down; `wrap` is the sampler's mode, likewise.
    pub fn new(map: &'a HeightMap, slope_per_step: [f32; 2], wrap: [Wrap; 2]) -> Self {
        // An infinite slope has no product with a flat place.
        let slope_per_step = slope_per_step.map(|s| s.clamp(f32::MIN, f32::MAX));
        Self { map, slope_per_step, wrap }
    }

    /// Covariance that rounding to the map's depth alone gives to slopes where the surface is flat: each of the two
    /// heights of a difference over two texels has the variance step^2 / 12.
    pub fn noise(&self) -> Symmetric2 {
        let step = self.map.step();
        let most = f64::from(MAX_SLOPE * MAX_SLOPE);
        let [uu, vv] = self.slope_per_step.map(|slope| {
            let rounding = f64::from(slope) * f64::from(step);
            (rounding * rounding / 24.0).min(most) as f32
        });
        Symmetric2::diagonal(uu, vv)
    }

    /// How many texels are steeper than [`MAX_SLOPE`].
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
        Outliers { steep, below: 0 }
    }

    /// Slopes across and up, in f64: differences of extreme heights overflow f32.
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

impl Rows for HeightOffsets<'_> {
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
mod tests {
    use super::*;
    use crate::image::{Image, Samples};

    fn slopes(heights: &[f32], width: u32, wrap: Wrap) -> Vec<Offset> {
        let height = heights.len() as u32 / width;
        let image = Image { width, height, channels: 1, samples: Samples::F32(heights.to_vec()) };
        let map = HeightMap::new(image).unwrap();
        let rows = HeightOffsets::new(&map, [1.0; 2], [wrap; 2]);
        let mut all = vec![Moments::default(); heights.len()];
        for (y, row) in all.chunks_exact_mut(width as usize).enumerate() {
            rows.row(y as u32, row);
        }
        all.iter().map(|m| m.mean).collect()
    }

    #[test]
    fn a_ramp_has_its_slope_at_the_border_too_when_clamped() {
        for offset in slopes(&[0.0, 0.5, 1.0, 1.5], 4, Wrap::Clamp) {
            assert_eq!(offset, Offset { u: 0.5, v: 0.0 });
        }
    }

    #[test]
    fn one_period_of_a_wave_has_no_seam_when_repeated() {
        let wave: Vec<f32> = (0..64).map(|i| (f64::from(i) / 64.0 * std::f64::consts::TAU).sin() as f32).collect();
        let offsets = slopes(&wave, 64, Wrap::Repeat);
        let step = std::f64::consts::TAU / 64.0;
        for (i, offset) in offsets.iter().enumerate() {
            // The central difference of a sine: cos(x) sin(step).
            let expected = (i as f64 * step).cos() * step.sin();
            assert!((f64::from(offset.u) - expected).abs() < 1e-6, "{i}");
        }
    }

    #[test]
    fn a_mirrored_ramp_halves_its_slope_at_the_fold() {
        let offsets = slopes(&[0.0, 1.0, 2.0, 3.0], 4, Wrap::Mirror);
        assert_eq!(offsets.iter().map(|o| o.u).collect::<Vec<_>>(), [0.5, 1.0, 1.0, 0.5]);
    }

    #[test]
    fn heights_rising_towards_row_0_have_a_positive_slope_along_b() {
        let offsets = slopes(&[2.0, 1.0, 0.0], 1, Wrap::Clamp);
        for offset in offsets {
            assert_eq!(offset, Offset { u: 0.0, v: 1.0 });
        }
    }

    /// Waves of a relief of a 4096th, in 8 and 16 bits, and in floats on top of a mountain: what their slopes differ by
    /// from the exact ones. Eight bits hold none of it.
    #[test]
    fn tiny_relief_survives_in_sixteen_bits_and_noise_tells_how_well() {
        let n = 128u32;
        let wave = |x: u32, base: f64| base + f64::sin(0.37 * f64::from(x)) / 8192.0;
        let exact = |x: u32| 0.5 * (wave(x + 1, 0.0) - wave(x.wrapping_sub(1), 0.0));
        let error = |base: f64, round: &dyn Fn(f64) -> f32, samples: &dyn Fn(Vec<f32>) -> Samples| {
            let heights = (0..n * 2).map(|i| round(wave(i % n, base))).collect();
            let map = HeightMap::new(Image { width: n, height: 2, channels: 1, samples: samples(heights) }).unwrap();
            let offsets = HeightOffsets::new(&map, [1.0; 2], [Wrap::Repeat; 2]);
            let mut row = vec![Moments::default(); n as usize];
            offsets.row(0, &mut row);
            let inner = 1..n - 1;
            let squares = inner.clone().map(|x| (f64::from(row[x as usize].mean.u) - exact(x)).powi(2));
            let signal = inner.map(|x| exact(x).powi(2)).sum::<f64>();
            (squares.sum::<f64>() / signal, f64::from(offsets.noise().uu) * f64::from(n - 2) / signal)
        };
        let integers = |one: f64| move |h: f64| (h * one).round() as f32;
        let bytes = |v: Vec<f32>| Samples::U8(v.iter().map(|h| *h as u8).collect());
        let words = |v: Vec<f32>| Samples::U16(v.iter().map(|h| *h as u16).collect());
        let (lost, _) = error(0.4, &integers(255.0), &bytes);
        assert_eq!(lost, 1.0, "one byte throughout: no wave at all");
        let (lost, told) = error(0.4, &integers(65535.0), &words);
        assert!(lost < 0.02 && (0.5..2.0).contains(&(lost / told)), "{lost} {told}");
        // Floats are as good as their magnitude allows: nothing lost at 0, and little at 100.
        assert!(error(0.0, &|h| h as f32, &Samples::F32).0 < 1e-12);
        let (lost, told) = error(100.0, &|h| h as f32, &Samples::F32);
        assert!(lost < told && lost > 0.05 * told, "{lost} {told}");
    }

    #[test]
    fn single_texels_are_flat() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            assert_eq!(slopes(&[0.7], 1, wrap), [Offset::default()]);
        }
    }
}
