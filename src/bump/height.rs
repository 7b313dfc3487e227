//! Offsets from heights: central differences that respect the sampler's wrap mode at the seam.

use rayon::prelude::*;

use super::{MAX_SLOPE, Offset};
use crate::map::HeightMap;
use crate::pyramid::{Moments, Rows};

/// What a sampler returns beyond the border, along one axis; named as in glTF.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Wrap {
    /// The map again: the neighbour of the last texel is the first.
    #[default]
    Repeat,
    /// The map mirrored: the neighbour of the last texel is itself, so heights have a crest or trough at the seam.
    Mirror,
    /// Nothing new: only texels inside count, so the slope at the border is a one-sided difference.
    Clamp,
}

impl Wrap {
    /// The texels before and after `i` on an axis of `size` texels, and their distance in texels.
    fn neighbours(self, i: u32, size: u32) -> (u32, u32, f32) {
        let last = size - 1;
        let before = i.checked_sub(1);
        let after = (i < last).then_some(i + 1);
        match self {
            Self::Repeat => (before.unwrap_or(last), after.unwrap_or(0), 2.0),
            Self::Mirror => (before.unwrap_or(0), after.unwrap_or(last), 2.0),
            Self::Clamp => {
                let (before, after) = (before.unwrap_or(i), after.unwrap_or(i));
                (before, after, ((after - before) as f32).max(1.0))
            }
        }
    }
}

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

    /// How many texels are steeper than [`MAX_SLOPE`].
    pub fn steep_texels(&self) -> u64 {
        (0..self.map.height())
            .into_par_iter()
            .map_init(
                || vec![[0.0; 2]; self.map.width() as usize],
                |slopes, y| {
                    self.slopes(y, slopes);
                    let limit = f64::from(MAX_SLOPE * MAX_SLOPE);
                    slopes.iter().filter(|[u, v]| u * u + v * v > limit).count() as u64
                },
            )
            .sum()
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
        let mut slopes = vec![[0.0; 2]; out.len()];
        self.slopes(y, &mut slopes);
        for (texel, [u, v]) in out.iter_mut().zip(slopes) {
            *texel = Moments::flat(Offset::clamped(u, v));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Image, Samples};

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

    #[test]
    fn single_texels_are_flat() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            assert_eq!(slopes(&[0.7], 1, wrap), [Offset::default()]);
        }
    }
}
