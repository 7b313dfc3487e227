use proptest::prelude::*;

use super::*;
use crate::bump::{NormalLayout, NormalMap, ShapedMoments};
use crate::image::{Image, Samples};
use crate::lobe::{Distribution, Family};
use crate::material::base::{Base, BaseRows};
use crate::mip::{Magnification, Sampler, Wrap};
use crate::settings::Settings;

/// Returns the matrix of squared alphas with these alphas and this angle of the first, in double precision.
fn matrix([along, across, angle]: [f64; 3]) -> [f64; 3] {
    let (sin, cos) = libm::sincos(angle);
    let [a, b] = [along * along, across * across];
    [a * cos * cos + b * sin * sin, (a - b) * sin * cos, a * sin * sin + b * cos * cos]
}

fn squared_alpha([uu, uv, vv]: [f64; 3]) -> SquaredAlpha {
    SquaredAlpha(Symmetric2::new(uu as f32, uv as f32, vv as f32))
}

/// Returns the matrix with eigenvalues limited to `range`, by the eigenvectors in double precision.
fn limited([uu, uv, vv]: [f64; 3], [least, most]: [f64; 2]) -> [f64; 3] {
    let (sin, cos) = libm::sincos(0.5 * libm::atan2(2.0 * uv, uu - vv));
    let along = uu * cos * cos + 2.0 * uv * sin * cos + vv * sin * sin;
    let across = uu * sin * sin - 2.0 * uv * sin * cos + vv * cos * cos;
    let [a, b] = [along, across].map(|e| e.clamp(least, most));
    [a * cos * cos + b * sin * sin, (a - b) * sin * cos, a * sin * sin + b * cos * cos]
}

fn determinant([uu, uv, vv]: [f64; 3]) -> f64 {
    uu * vv - uv * uv
}

proptest! {
    #[test]
    fn added_covariance_is_the_limited_difference(
        base in prop::array::uniform3(0.05..1.0f64), roughened in prop::array::uniform3(0.05..1.5f64),
    ) {
        let [base, roughened] = [matrix(base), matrix(roughened)];
        let k = added_covariance(squared_alpha(base), squared_alpha(roughened));
        let shown = limited(roughened, [0.0, 1.0]);
        let difference = [0, 1, 2].map(|i| shown[i] - base[i]);
        let expected = limited(difference, [0.0, f64::INFINITY]).map(|e| 0.5 * e);
        for (found, expected) in [k.uu, k.uv, k.vv].into_iter().zip(expected) {
            prop_assert!((f64::from(found) - expected).abs() < 1e-5, "{k:?}, {expected}");
        }
        let smaller = f64::from(k.trace()) / 2.0 - f64::from(0.5 * (k.uu - k.vv)).hypot(f64::from(k.uv));
        prop_assert!(smaller > -1e-6, "{k:?}");
    }

    #[test]
    fn isotropic_variance_gives_the_determinant_of_the_roughened_lobe(
        base in prop::array::uniform3(0.05..0.5f64), roughened in prop::array::uniform3(0.5..1.0f64),
    ) {
        let [[uu, uv, vv], roughened] = [matrix(base), matrix(roughened)];
        let v = added_isotropic_variance(squared_alpha([uu, uv, vv]), squared_alpha(roughened));
        let added = 2.0 * f64::from(v);
        let found = determinant([uu + added, uv, vv + added]);
        prop_assert!((found / determinant(roughened) - 1.0).abs() < 1e-4, "{found}, {roughened:?}");
    }
}

#[test]
fn a_narrower_lobe_loses_no_bumps() {
    let [narrow, wide] = [matrix([0.1, 0.1, 0.0]), matrix([0.5, 0.3, 1.0])].map(squared_alpha);
    assert_eq!(added_covariance(wide, narrow), Symmetric2::ZERO);
    assert_eq!(added_isotropic_variance(wide, narrow), 0.0);
}

const SIDE: u32 = 16;

/// Returns a map whose slopes along u are +-0.4 and along v smaller, but for some texels of the slope `steep`.
fn bump_map(side: u32, steep: f32) -> BumpMap {
    let texel = |i: u32| {
        let (x, y) = (i % side, i / side);
        let u = if (x + y) % 3 == 0 { -0.4 } else { 0.2 + 0.01 * y as f32 };
        let v = if i % 71 == 5 { steep } else { 0.1 * ((i * 7) % 5) as f32 - 0.2 };
        [-u, -v, 1.0]
    };
    let samples = Samples::F32((0..side * side).flat_map(texel).collect());
    let image = Image { width: side, height: side, channels: 3, samples };
    BumpMap::Normals(NormalMap::new(image, NormalLayout::Xyz, false).unwrap())
}

/// Returns the roughening of a base lobe of roughness 0.5 by `bumps`, whose texels are shown as they are.
fn roughening<'a>(bumps: &Bumps<'a>, slope_scale: f32, settings: &Settings) -> Roughening<'a> {
    let (width, height) = bumps.size();
    let base = Base::new(BaseRows::new(width, height, None, 0.5, None, [Wrap::Repeat; 2]));
    let sampler = Sampler { magnification: Magnification::Nearest, ..Sampler::default() };
    Roughening::new(base, bumps, slope_scale, sampler, settings)
}

fn rows(levels: &dyn PyramidLevels) -> impl Iterator<Item = (usize, u32, Vec<PyramidTexel>)> {
    levels.sizes().into_iter().enumerate().flat_map(move |(level, (width, height))| {
        (0..height).map(move |y| {
            let mut row = vec![PyramidTexel::default(); width as usize];
            levels.row(level, y, &mut row);
            (level, y, row)
        })
    })
}

/// A plugin that adds 2 K to the base lobe shows the lobes of the portable profile.
#[test]
fn lobe_levels_give_the_roughened_lobes() {
    let map = bump_map(SIDE, 9.0);
    let bumps = Bumps::new(&map, (SIDE, SIDE));
    let scale = 0.75;
    let roughening = roughening(&bumps, scale, &Settings::default());
    let levels = LobeLevels::new(&bumps, &roughening);
    for (level, y, row) in rows(&levels) {
        let roughened = roughening.roughened_row(level, y, row.len());
        let base = roughening.base_row(level, y, row.len());
        for ((texel, SquaredAlpha(roughened)), base) in row.iter().zip(roughened).zip(base) {
            if level == 0 {
                assert_eq!((texel.covariance, texel.isotropic), (Symmetric2::ZERO, 0.0));
            }
            let k = scale * scale * texel.covariance;
            let Symmetric2 { uu, uv, vv } = base.roughen(k).0 + -1.0 * roughened;
            assert!([uu, uv, vv].iter().all(|e| e.abs() < 1e-6), "level {level}: {texel:?}, {roughened:?}");
            let isotropic = base.0.uu + 2.0 * scale * scale * texel.isotropic;
            assert!((isotropic - roughened.determinant().sqrt()).abs() < 1e-5, "level {level}: {isotropic}");
        }
    }
    let lost = lost_variance(&levels);
    assert!(lost > 0.0 && lost == lost_variance_of_lobes(&roughening));
}

/// Under a fixed distribution, K of a lobe is c times the covariance, with the factor c of each texel.
#[test]
fn fixed_distributions_keep_the_corrected_covariance() {
    let map = bump_map(SIDE, 0.5);
    let bumps = Bumps::new(&map, (SIDE, SIDE));
    let base = SquaredAlpha(Symmetric2::diagonal(0.0625, 0.0625));
    let scale = 0.25;
    for (distribution, family) in [
        (Distribution::Normal, Family::Ggx),
        (Distribution::Uniform, Family::Ggx),
        (Distribution::Normal, Family::Beckmann),
    ] {
        let settings = Settings { distribution, lobe: family, ..Settings::default() };
        let levels = LobeLevels::new(&bumps, &roughening(&bumps, scale, &settings));
        for ((level, _, row), (_, _, moments)) in rows(&levels).zip(rows(bumps.moments())).skip(SIDE as usize) {
            for (found, plain) in row.iter().zip(&moments) {
                let m = Moments { mean: plain.offset, covariance: plain.covariance };
                let unscaled = SquaredAlpha(1.0 / (scale * scale) * base.0);
                let expected = distribution.correct(&ShapedMoments::normal(m), unscaled, family).covariance;
                let Symmetric2 { uu, uv, vv } = found.covariance + -1.0 * expected;
                let tolerance = 1e-4 * expected.trace().max(0.01);
                assert!([uu, uv, vv].iter().all(|e| e.abs() < tolerance), "{distribution:?}, level {level}: {found:?}");
            }
        }
    }
}

/// Resampled texels have lost bumps at level 0.
#[test]
fn resampled_maps_lose_bumps_at_level_0() {
    let map = bump_map(6, 9.0);
    let bumps = Bumps::new(&map, (8, 8));
    let levels = LobeLevels::new(&bumps, &roughening(&bumps, 1.0, &Settings::default()));
    let mut row = vec![PyramidTexel::default(); 8];
    levels.row(0, 1, &mut row);
    assert!(row.iter().any(|texel| texel.covariance.trace() > 0.001 && texel.isotropic > 0.0), "{row:?}");
}

#[test]
fn a_rotation_by_90_degrees_exchanges_the_axes() {
    let map = bump_map(SIDE, 9.0);
    let bumps = Bumps::new(&map, (SIDE, SIDE));
    let rotated = Rotated { levels: bumps.moments(), transform: FrameTransform::rotation(0.0, 1.0) };
    for ((_, _, found), (_, _, plain)) in rows(&rotated).zip(rows(bumps.moments())) {
        for (found, plain) in found.iter().zip(&plain) {
            assert_eq!(found.offset, Offset { u: -plain.offset.v, v: plain.offset.u });
            assert_eq!((found.covariance.uu, found.covariance.vv), (plain.covariance.vv, plain.covariance.uu));
            assert_eq!(found.isotropic, plain.isotropic);
        }
    }
}
