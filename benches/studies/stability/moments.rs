//! E[x^2] - E[x]^2 in half and single floats, compared with central moments.

use half::f16;
use roughcast::lobe::Factor;
use roughcast::mip::{Level, Pyramid};

use super::synthetic::{Random, level};
use super::{head, row};

/// Texels along each side of one footprint of level 7.
const SIZE: u32 = 128;

pub fn print() {
    head(
        "Moment subtraction",
        &["mean slope", "deviation", "raw moments, half", "raw moments, float", "central, float", "D as half floats"],
    );
    for mean in [0.1, 0.3, 1.0, 3.0] {
        for deviation in [0.1, 0.01, 0.001] {
            let mut random = Random(17);
            let source = level(SIZE, SIZE, |_, _| [mean + deviation * 12f64.sqrt() * (random.next() - 0.5), 0.0]);
            let n = source.texels.len() as f64;
            let exact_mean = source.texels.iter().map(|t| f64::from(t.mean.u)).sum::<f64>() / n;
            let exact = source.texels.iter().map(|t| (f64::from(t.mean.u) - exact_mean).powi(2)).sum::<f64>() / n;

            let raw = source.texels.iter().map(|t| [t.mean.u, t.mean.u * t.mean.u]).collect();
            let [first, second] = Pyramid::new(Level { width: SIZE, height: SIZE, texels: raw }).coarsest();
            let subtract = |first: f64, second: f64| second - first * first;
            let half = |x: f32| f16::from_f32(x).to_f64();
            let central = Pyramid::new(&source).coarsest().covariance;
            let stored = f16::from_f32(Factor::of(central).d1).to_f64();
            let variances = [
                subtract(half(first), half(second)),
                subtract(f64::from(first), f64::from(second)),
                f64::from(central.uu),
                stored * stored,
            ];
            // The deviation from the computed variance. A negative variance gives none.
            let error = |variance: f64| match (variance.max(0.0) / exact).sqrt() {
                0.0 => "lost".to_owned(),
                ratio => format!("{:+.2} %", 100.0 * (ratio - 1.0)),
            };
            row(&[mean.to_string(), deviation.to_string()].into_iter().chain(variances.map(error)).collect::<Vec<_>>());
        }
    }
}
