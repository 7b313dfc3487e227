use super::*;
use crate::bump::{Moments, Offset};
use crate::lobe::Factor;
use crate::math::symmetric::Symmetric2;
use crate::mip::{Level, Pyramid};

/// Two texels of rank 1, at +45 and -45 degrees, have D = [[0, +-s], [0, s]]. Filtering cancels d2 and with it half of
/// the variance, all of it along u.
#[test]
fn filtering_d_loses_the_difference_of_its_texels() {
    let texel = |sign: f32| Moments { covariance: Symmetric2::outer([sign, 1.0]), ..Moments::default() };
    // Level 1 of a map of 4 x 2 texels whose halves vary that way.
    let offsets = |sign: f32, scale: f32| {
        let mean = Offset { u: sign * scale, v: scale };
        Moments::flat(mean)
    };
    let row = [offsets(1.0, 1.0), offsets(1.0, -1.0), offsets(-1.0, 1.0), offsets(-1.0, -1.0)];
    let pyramid = Pyramid::new(Level { width: 4, height: 2, texels: [row, row].concat() });
    let mut level = [Moments::default(); 2];
    pyramid.row(1, 0, &mut level);
    assert_eq!(level, [texel(1.0), texel(-1.0)]);
    let loss = filter_loss(&pyramid);
    assert!((loss - 0.5).abs() < 1e-6, "{loss}");
    let [a, b] = level.map(|m| Quantity::Factor.of(PyramidTexel { covariance: m.covariance, ..Default::default() }));
    let d: [f32; 3] = std::array::from_fn(|i| 0.5 * (a[i] + b[i]));
    let filtered = Factor { d1: d[0], d2: d[1], d3: d[2] }.covariance();
    let mean = 0.5 * (level[0].covariance + level[1].covariance);
    assert!((1.0 - filtered.trace() / mean.trace() - loss).abs() < 1e-6, "{filtered:?} {mean:?}");
}

#[test]
fn filtering_equal_neighbours_loses_nothing() {
    let texels = (0..64).map(|i| Moments::flat(Offset { u: (i % 2) as f32, v: 0.0 })).collect();
    assert_eq!(filter_loss(&Pyramid::new(Level { width: 8, height: 8, texels })), 0.0);
    let flat = Level { width: 1, height: 1, texels: vec![Moments::default()] };
    assert_eq!(filter_loss(&Pyramid::new(flat)), 0.0);
}
