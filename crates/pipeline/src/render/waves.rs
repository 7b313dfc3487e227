//! Waves for the lake, for use without a bump map.

use std::f64::consts::TAU;

use rayon::prelude::*;

/// Returns heights of repeating waves, `size` x `size` texels, in units of a repeat. The waves are sines with
/// directions within 60 degrees of the wind; shorter waves are lower. Their root mean square slope is about 0.14. All
/// machines give equal heights.
pub fn waves(size: u32) -> Vec<f32> {
    let mut state = 7u32;
    let mut random = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        f64::from(state >> 8) / f64::from(1 << 24)
    };
    let mut frequency = 3.0;
    let sines: Vec<[f64; 4]> = (0..60)
        .map(|_| {
            let (sin, cos) = libm::sincos((random() - 0.5) * TAU / 3.0 + TAU / 4.0);
            let (u, v) = ((frequency * cos).round(), (frequency * sin).round());
            frequency *= 1.055;
            [u, v, random() * TAU, 0.0058 / (u * u + v * v).max(1.0).sqrt()]
        })
        .collect();
    // Tables of a and b give sin(a + b), since a sine for each texel and wave would take seconds.
    let table = |axis: usize, phased: bool| -> Vec<(f64, f64)> {
        let angles = sines.iter().flat_map(|s| {
            (0..size).map(move |i| TAU * s[axis] * f64::from(i) / f64::from(size) + if phased { s[2] } else { 0.0 })
        });
        angles.map(libm::sincos).collect()
    };
    let (across, down) = (table(0, true), table(1, false));
    let at = |wave: usize, i: u32| wave * size as usize + i as usize;
    let height = |x: u32, y: u32| {
        let part = |(wave, s): (usize, &[f64; 4])| {
            let ((sin_a, cos_a), (sin_b, cos_b)) = (across[at(wave, x)], down[at(wave, y)]);
            s[3] * (sin_a * cos_b + cos_a * sin_b)
        };
        sines.iter().enumerate().map(part).sum::<f64>() as f32
    };
    (0..size).into_par_iter().flat_map_iter(|y| (0..size).map(move |x| (x, y))).map(|(x, y)| height(x, y)).collect()
}
