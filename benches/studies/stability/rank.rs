//! Covariances of rank 0 and 1: brushed metal and flat texels.

use roughcast::lobe::{Alpha, Anisotropy, SquaredAlpha};
use roughcast::lobe::{Factor, lambda_1};
use roughcast::math::symmetric::Symmetric2;

use super::synthetic::Random;
use super::{head, row};

pub fn print() {
    head(
        "K of rank 0 and 1",
        &["deviations", "K - D D^T, largest, over the trace", "lambda_1, largest relative error", "not finite"],
    );
    let ranges =
        [("0", None), ("1e-20 to 1e-9", Some((-20, -9))), ("1e-9 to 1", Some((-9, 0))), ("1 to 16", Some((0, 1)))];
    for (name, exponents) in ranges {
        let mut random = Random(5);
        let (mut factor_error, mut lambda_error, mut broken) = (0f64, 0f64, 0);
        for _ in 0..100_000 {
            let angle = std::f64::consts::TAU * random.next();
            let size = exponents.map_or(0.0, |(from, to)| {
                let exponent = f64::from(from) + f64::from(to - from) * random.next();
                if to > 0 { 16f64.powf(exponent) } else { 10f64.powf(exponent) }
            });
            let v = [(size * angle.cos()) as f32, (size * angle.sin()) as f32];
            let k = Symmetric2::outer(v);
            let back = Factor::of(k).covariance();
            let off = [(back.uu, k.uu), (back.uv, k.uv), (back.vv, k.vv)].map(|(a, b)| f64::from(a - b).abs());
            let lobe = Anisotropy::of(SquaredAlpha::isotropic(Alpha(0.0)).roughen(k), [1.0, 0.0]);
            let all = [back.uu, back.uv, back.vv, lambda_1(k), lobe.roughness.0, lobe.strength, lobe.direction[0]];
            broken += usize::from(all.iter().any(|x| !x.is_finite()));
            if k.trace() > 0.0 {
                factor_error = off.iter().fold(factor_error, |m, o| m.max(o / f64::from(k.trace())));
                let exact = f64::from(v[0]).hypot(f64::from(v[1]));
                lambda_error = lambda_error.max((f64::from(lambda_1(k)) / exact - 1.0).abs());
            }
        }
        let error = |e: f64| if e > 0.0 { format!("{e:.1e}") } else { "0".to_owned() };
        row(&[name.to_owned(), error(factor_error), error(lambda_error), broken.to_string()]);
    }
}
