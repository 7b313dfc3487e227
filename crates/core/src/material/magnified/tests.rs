use super::*;
use crate::bump::Offset;
use crate::lobe::Alpha;
use crate::metric::Surface;
use crate::mip::Level;

/// Slopes of white noise, small enough for slopes and normals to be proportional.
fn noise(side: u32, deviation: f32) -> Level<OrientedLobe> {
    let mut state = 1_u32;
    let mut next = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        ((state >> 8) as f32 / (1 << 24) as f32 - 0.5) * deviation * 12.0_f32.sqrt()
    };
    let mut texel = || {
        let alpha = SquaredAlpha::isotropic(Alpha(0.1 + next().abs()));
        OrientedLobe::new(Offset { u: next(), v: next() }, alpha)
    };
    let texels = (0..side * side).map(|_| texel()).collect();
    Level { width: side, height: side, texels }
}

/// The integral of the squared bilinear interpolation of white noise is (2/3)^2 of the noise's variance: what the mean
/// normals of texels lose of it is in their lobes.
#[test]
fn white_noise_keeps_four_ninths_of_its_variance() {
    let flat = |lobe: &OrientedLobe| lobe.squared_alpha.0.trace() - 2.0 * 0.1_f32.powi(2);
    for wrap in [Wrap::Repeat, Wrap::Clamp] {
        let mut source = noise(128, 0.005);
        source.texels.iter_mut().for_each(|lobe| lobe.squared_alpha = SquaredAlpha::isotropic(Alpha(0.1)));
        let magnified = Magnified { source: &source, wrap: Some([wrap; 2]), is_isotropic: true };
        let (mut variance, mut row) = (0.0, vec![OrientedLobe::default(); 128]);
        for y in 0..128 {
            magnified.row(y, &mut row);
            for lobe in &row {
                let Offset { u, v } = lobe.offset();
                variance += f64::from(u * u + v * v + 0.5 * flat(lobe));
            }
        }
        let squares = |lobe: &OrientedLobe| f64::from(lobe.offset().u.powi(2) + lobe.offset().v.powi(2));
        let ratio = variance / source.texels.iter().map(squares).sum::<f64>();
        assert!((ratio - 4.0 / 9.0).abs() < 0.01, "{wrap:?}: {ratio}");
    }
}

/// Mean normal, mean roughness and covariance are those of 4 x 4 points of the surface in double precision.
#[test]
fn texels_agree_with_points_in_double_precision() {
    let source = noise(8, 0.02);
    let normals: Vec<_> = source.texels.iter().map(|lobe| lobe.normal.map(f64::from)).collect();
    let alphas: Vec<_> = source.texels.iter().map(|lobe| lobe.squared_alpha).collect();
    let surface = Surface::new(8, 8, &normals, &alphas).unwrap().magnified();
    let magnified = Magnified { source: &source, wrap: Some([Wrap::Repeat; 2]), is_isotropic: true };
    let mut row = vec![OrientedLobe::default(); 8];
    for y in 0..8 {
        magnified.row(y, &mut row);
        for (x, lobe) in (0..).zip(&row) {
            let moments = surface.footprint((8, 8), (x, y)).moments();
            let Offset { u, v } = lobe.offset();
            for (found, wanted) in [u, v].into_iter().zip(moments.mean) {
                assert!((f64::from(found) - wanted).abs() < 0.003, "{x} {y}: {found} {wanted}");
            }
            let a = lobe.squared_alpha.0;
            for (i, found) in [a.uu, a.uv, a.vv].into_iter().enumerate() {
                let wanted = moments.base[i] + 2.0 * moments.covariance[i];
                assert!((f64::from(found) - wanted).abs() < 0.1 * wanted.abs() + 1e-3, "{x} {y}: {found} {wanted}");
            }
        }
    }
}

/// Isotropic lobes are widened by fewer numbers, to the same bits.
#[test]
fn isotropic_lobes_need_fewer_numbers() {
    let source = noise(20, 0.3);
    let [few, all] = [true, false].map(|is_isotropic| {
        let magnified = Magnified { source: &source, wrap: Some([Wrap::Repeat; 2]), is_isotropic };
        let mut rows = vec![OrientedLobe::default(); 400];
        magnified.rows(0, &mut rows);
        rows
    });
    assert_eq!(few, all);
}

/// Between a rough and a smooth texel the roughness is interpolated, not the squared alpha.
#[test]
fn roughness_is_interpolated() {
    let lobe = |roughness: f32| OrientedLobe {
        normal: [0.0, 0.0, 1.0],
        squared_alpha: SquaredAlpha(Symmetric2::diagonal(roughness.powi(4), roughness.powi(4))),
    };
    let texels = (0..16).map(|i| lobe(if i % 2 == 0 { 0.2 } else { 0.8 })).collect();
    let source = Level { width: 4, height: 4, texels };
    let mut row = [OrientedLobe::default(); 4];
    Magnified { source: &source, wrap: Some([Wrap::Repeat; 2]), is_isotropic: true }.row(0, &mut row);
    let wanted = (1.0 - SHARE) * 0.2 + SHARE * 0.8;
    let roughness = row[0].squared_alpha.0.uu.powf(0.25);
    assert!((roughness - wanted).abs() < 1e-5, "{roughness}");
}
