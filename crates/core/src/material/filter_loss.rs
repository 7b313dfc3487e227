//! What bilinear filtering of D loses.

use rayon::prelude::*;

use crate::material::pyramid_levels::{PyramidLevels, PyramidTexel};
use crate::material::quantity::Quantity;

/// Returns the share of the variance that filtering D in place of K loses halfway between neighbouring texels, at the
/// level that loses most. With D the mean of D1 and D2, (K1 + K2)/2 - D D^T = (D1 - D2)(D1 - D2)^T / 4, which is never
/// negative.
pub fn filter_loss(levels: &dyn PyramidLevels) -> f32 {
    let sizes = levels.sizes();
    let of_level = |(level, &(width, height)): (usize, &(u32, u32))| {
        let factors = |y: u32, out: &mut Vec<[f32; 3]>| {
            let mut texels = vec![PyramidTexel::default(); width as usize];
            levels.row(level, y, &mut texels);
            out.clear();
            out.extend(texels.into_iter().map(|texel| Quantity::Factor.of(texel)));
        };
        let in_row = |(row, below): &mut (Vec<[f32; 3]>, Vec<[f32; 3]>), y: u32| {
            factors(y, row);
            let is_last = y + 1 == height;
            if !is_last {
                factors(y + 1, below);
            }
            let right = row.iter().zip(row.iter().skip(1));
            let down = row.iter().zip(below.iter()).filter(|_| !is_last);
            right.chain(down).fold([0.0; 2], |[lost, total], (a, b)| {
                let elements = a.iter().zip(b).map(|(a, b)| (f64::from(*a), f64::from(*b)));
                elements.fold([lost, total], |[lost, total], (a, b)| {
                    [lost + 0.25 * (a - b) * (a - b), total + 0.5 * (a * a + b * b)]
                })
            })
        };
        let rows: Vec<[f64; 2]> = (0..height).into_par_iter().map_init(Default::default, in_row).collect();
        let [lost, total] = rows.iter().fold([0.0; 2], |[l, t], [lost, total]| [l + lost, t + total]);
        if total > 0.0 { (lost / total) as f32 } else { 0.0 }
    };
    // Level 0 has no variance.
    sizes.iter().enumerate().skip(1).map(of_level).fold(0.0, f32::max)
}

#[cfg(test)]
mod tests;
