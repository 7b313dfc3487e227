//! Measurements of a roughened lobe, for notes to the user. They sample the rows of a level.

use rayon::prelude::*;

use crate::lobe::{Anisotropy, SquaredAlpha, isotropic_distance};
use crate::material::roughening::Roughening;
use crate::math::symmetric::Symmetric2;
use crate::settings::Model;

/// Smallest axis ratio at which the direction of a lobe counts. An isotropic lobe in place of such a lobe has an error
/// of 0.13.
const CLEARLY_ANISOTROPIC: f32 = 1.5;

/// Returns the rows of a level that are sampled: all rows, or 65 of them. The number is odd so that the samples do not
/// alias with patterns that repeat by powers of two.
fn sampled_rows(height: u32) -> impl IndexedParallelIterator<Item = u32> {
    let count = height.min(65);
    (0..count).into_par_iter().map(move |i| (u64::from(i) * u64::from(height) / u64::from(count)) as u32)
}

impl Roughening<'_> {
    /// Returns about how many texels of all levels have a lobe under `model` with an alpha above 1, which no engine
    /// shows.
    pub fn texels_above_one(&self, model: Model) -> u64 {
        let is_too_wide = |lobe: SquaredAlpha| match model {
            Model::Anisotropic => lobe.exceeds_one(),
            _ => lobe.isotropic_exceeds_one(),
        };
        let in_level = |(level, (width, height)): (usize, (u32, u32))| -> u64 {
            let in_row = |y| {
                let lobes = self.roughened_row(level, y, width as usize);
                lobes.into_iter().filter(|lobe| is_too_wide(*lobe)).count() as u64
            };
            let rows = sampled_rows(height);
            let sampled = rows.len() as u64;
            rows.map(in_row).sum::<u64>() * u64::from(height) / sampled
        };
        self.sizes().into_iter().enumerate().map(in_level).sum()
    }

    /// Returns the mean distance by which noise of covariance `noise` in the bumps moves the lobes of level 1, where
    /// noise weighs most.
    pub fn noise_loss(&self, noise: Symmetric2) -> f32 {
        let Some(&(width, height)) = self.sizes().get(1) else { return 0.0 };
        let noise = noise.scaled([self.lobes().slope_scale(); 2]);
        let distance = |lobe: SquaredAlpha| {
            let noisier = lobe.roughen(noise);
            f64::from(isotropic_distance(lobe.closest_isotropic(), noisier.closest_isotropic()))
        };
        let in_row = |y| self.roughened_row(1, y, width as usize).into_iter().map(distance).sum::<f64>();
        let rows: Vec<f64> = sampled_rows(height).map(in_row).collect();
        (rows.iter().sum::<f64>() / (f64::from(width) * rows.len() as f64)) as f32
    }

    /// Returns the share of texels of levels 2 and coarser whose stored direction is opposed to the direction of the
    /// texel to the right or below, where both lobes are clearly anisotropic. Filtering between such texels loses the
    /// direction.
    pub fn opposed_share(&self) -> f32 {
        let axis = self.reference_axis();
        let direction = |lobe: SquaredAlpha| match lobe.axis_ratio() > CLEARLY_ANISOTROPIC {
            true => Anisotropy::of(lobe, axis).direction,
            false => [0.0; 2],
        };
        let (mut count, mut total) = (0.0, 0.0);
        for (level, (width, height)) in self.sizes().into_iter().enumerate().skip(2) {
            let directions = |y: u32, out: &mut Vec<[f32; 2]>| {
                out.clear();
                out.extend(self.roughened_row(level, y, width as usize).into_iter().map(direction));
            };
            let in_row = |(row, below): &mut (Vec<[f32; 2]>, Vec<[f32; 2]>), y: u32| {
                directions(y, row);
                directions((y + 1).min(height - 1), below);
                opposed_in_row(row, below)
            };
            let (rows, texels) = (sampled_rows(height), f64::from(width) * f64::from(height));
            let sampled = rows.len() as f64 * f64::from(width);
            count += rows.map_init(Default::default, in_row).sum::<usize>() as f64 * texels / sampled;
            total += texels;
        }
        if total > 0.0 { (count / total) as f32 } else { 0.0 }
    }
}

/// Counts the directions of `row` that are opposed to the direction to the right or below. 0 is opposed to no
/// direction.
fn opposed_in_row(row: &[[f32; 2]], below: &[[f32; 2]]) -> usize {
    let is_opposed = |a: &[f32; 2], b: &[f32; 2]| a[0] * b[0] + a[1] * b[1] < 0.0;
    let right = row.iter().skip(1).chain(row.last());
    let texels = row.iter().zip(right).zip(below);
    texels.filter(|((texel, right), below)| is_opposed(texel, right) || is_opposed(texel, below)).count()
}

#[cfg(test)]
mod tests;
