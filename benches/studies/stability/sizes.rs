//! Conservation of variance for odd sizes, one row or column, and one texel.

use roughcast::bump::{Moments, Offset};
use roughcast::math::symmetric::Symmetric2;
use roughcast::mip::{Level, Pyramid, level_size};

use super::synthetic::{Random, level, texels};
use super::{head, row};

pub fn print() {
    head(
        "Odd sizes: variance of the whole map at the worst level, against level 0",
        &["size", "polyphase boxes", "boxes of 2 x 2 that leave odd rows out"],
    );
    for (width, height) in [(64, 64), (5, 3), (7, 1), (1, 75), (1, 1), (745, 745), (1023, 511)] {
        let mut random = Random(u64::from(width * 7 + height));
        // Slopes grow towards the right, so that texels that are left out matter.
        let source = level(width, height, |x, _| {
            let scale = f64::from(x + 1) / f64::from(width);
            [scale * (random.next() - 0.5), 0.3 * (random.next() - 0.5)]
        });
        let exact = total(&source.texels);
        let pyramid = Pyramid::new(source.clone());
        let deviation = |level: &[Moments]| (total(level) / exact - 1.0).abs();
        let ours = (0..pyramid.sizes().len()).map(|l| deviation(&texels(&pyramid, l))).fold(0.0, f64::max);
        let (mut naive, mut worst) = (source, 0f64);
        while (naive.width, naive.height) != (1, 1) {
            naive = boxes(&naive);
            worst = worst.max(deviation(&naive.texels));
        }
        let percent = |x: f64| if exact > 0.0 { format!("{:.4} %", 100.0 * x) } else { "none".to_owned() };
        row(&[format!("{width} x {height}"), percent(ours), percent(worst)]);
    }
}

/// Returns the trace of mean(K) + cov(m).
fn total(texels: &[Moments]) -> f64 {
    let n = texels.len() as f64;
    let mean = |f: &dyn Fn(&Moments) -> f64| texels.iter().map(f).sum::<f64>() / n;
    let (u, v) = (mean(&|m| f64::from(m.mean.u)), mean(&|m| f64::from(m.mean.v)));
    let spread = |m: &Moments| (f64::from(m.mean.u) - u).powi(2) + (f64::from(m.mean.v) - v).powi(2);
    mean(&|m| f64::from(m.covariance.trace()) + spread(m))
}

/// Makes the next level by boxes of 2 x 2, for any size.
fn boxes(fine: &Level<Moments>) -> Level<Moments> {
    let (width, height) = (level_size(fine.width), level_size(fine.height));
    let texel = |i: u32| {
        let at = |c: u32, d: u32, size: u32| (2 * c + d).min(size - 1);
        let parts = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| {
            fine.texels[(at(i / width, dy, fine.height) * fine.width + at(i % width, dx, fine.width)) as usize]
        });
        let mean =
            parts.iter().fold(Offset::default(), |m, p| Offset { u: m.u + 0.25 * p.mean.u, v: m.v + 0.25 * p.mean.v });
        let covariance = parts.iter().fold(Symmetric2::ZERO, |k, p| {
            k + 0.25 * (p.covariance + Symmetric2::outer([p.mean.u - mean.u, p.mean.v - mean.v]))
        });
        Moments { mean, covariance }
    };
    Level { width, height, texels: (0..width * height).map(texel).collect() }
}
