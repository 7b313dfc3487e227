use super::*;
use crate::bump::Moments;
use crate::material::bumps::Bumps;
use crate::material::pyramid_levels::{LobeLevels, PyramidLevels, PyramidTexel};
use crate::material::rust_and_steel::{RustAndSteel, SIDE};
use crate::math::symmetric::Symmetric2;
use crate::mip::Sampler;
use crate::settings::{Profile, Settings};

fn roughening<'a>(material: &'a RustAndSteel, bumps: &Bumps<'a>, profile: Profile) -> Roughening<'a> {
    let settings = Settings { profile, ..Settings::default() };
    Roughening::new(material.base(true), bumps, 1.0, Sampler::default(), &settings)
}

/// Returns row `y` of `level` of the texture.
fn row(roughening: &Roughening<'_>, level: usize, y: u32) -> Vec<[f32; 4]> {
    let mut row = vec![[0.0; 4]; (SIDE >> level) as usize];
    BaseRoughnessTexture(roughening).row(level, y, &mut row);
    row
}

/// What the pyramid profile stores of a texel, and what it is made from.
struct Texel {
    level: usize,
    /// Squared alpha of the texture.
    base: f32,
    /// Squared alpha of the mean roughness.
    mean: f32,
    roughened: Symmetric2,
    k: Symmetric2,
    /// Covariance of the bumps.
    bumps: Symmetric2,
}

/// Returns the texels of all levels from 1 on.
fn texels(material: &RustAndSteel) -> Vec<Texel> {
    let bumps = Bumps::new(&material.bump_map, (SIDE, SIDE));
    let roughening = roughening(material, &bumps, Profile::Pyramid);
    let levels = LobeLevels::new(&bumps, &roughening);
    let mut all = Vec::new();
    for (level, y) in (1..=6).flat_map(|level| (0..SIDE >> level).map(move |y| (level, y))) {
        let width = (SIDE >> level) as usize;
        let (mut stored, mut moments) = (vec![PyramidTexel::default(); width], vec![Moments::default(); width]);
        levels.row(level, y, &mut stored);
        bumps.moments().row(level, y, &mut moments);
        let (mean, roughened) = (roughening.base_row(level, y, width), roughening.roughened_row(level, y, width));
        let texture = row(&roughening, level, y);
        all.extend((0..width).map(|x| Texel {
            level,
            base: texture[x][1].powi(4),
            mean: mean[x].0.uu,
            roughened: roughened[x].0,
            k: stored[x].covariance,
            bumps: moments[x].covariance,
        }));
    }
    all
}

/// Steel reflects more than the rust beside it, so that the lobe is narrower than the mean of the base lobes. K has no
/// more than 1.5 times the variance of the bumps, where the lobe is wider for another reason.
#[test]
fn the_texture_with_k_is_the_roughened_lobe_even_where_that_is_narrow() {
    let (mut narrower, mut limited) = (0, 0);
    for Texel { level, base, mean, roughened, k, bumps } in texels(&RustAndSteel::new()) {
        let most = 1.5 * bumps.trace();
        assert!(k.trace() <= 1.001 * most, "level {level}: {} for bumps of {most}", k.trace());
        if k.trace() >= 0.999 * most {
            limited += 1;
            continue;
        }
        let found = [base + 2.0 * k.uu, 2.0 * k.uv, base + 2.0 * k.vv];
        for (found, expected) in found.into_iter().zip([roughened.uu, roughened.uv, roughened.vv]) {
            assert!((found - expected).abs() < 1e-5, "level {level}: {found}, {expected}");
        }
        narrower += usize::from(mean > base + 0.01);
    }
    assert!(narrower > 0, "the mean of base lobes is wider somewhere");
    assert!(limited > 0, "rust beside steel widens a lobe more than its bumps somewhere");
}

/// Plugins take K for facets of the base lobe, so that K has no more than the variance of the bumps.
#[test]
fn the_texture_has_the_width_that_comes_from_other_roughness() {
    let mut wider = 0;
    for Texel { level, base, mean, k, bumps, .. } in texels(&RustAndSteel::new()) {
        let (smaller, most) = (k.eigen().minor, bumps.eigen().major);
        let is_mean = base <= mean + 1e-5;
        assert!(is_mean || smaller <= most + 1e-5, "level {level}: K of {smaller} for bumps of {most}");
        wider += usize::from(!is_mean);
    }
    assert!(wider > 0, "the base lobe is wider than the mean somewhere");
}

/// The mean metalness is a half; steel has most of the colour.
#[test]
fn metalness_counts_by_base_colour() {
    let material = RustAndSteel::new();
    let bumps = Bumps::new(&material.bump_map, (SIDE, SIDE));
    let roughening = roughening(&material, &bumps, Profile::Pyramid);
    let [_, _, metalness, _] = row(&roughening, 6, 0)[0];
    assert!(metalness > 0.8, "{metalness}");
}

#[test]
fn only_the_pyramid_needs_the_texture() {
    let material = RustAndSteel::new();
    let bumps = Bumps::new(&material.bump_map, (SIDE, SIDE));
    for (profile, is_needed) in [(Profile::Portable, false), (Profile::Pyramid, true), (Profile::Both, true)] {
        assert_eq!(roughening(&material, &bumps, profile).needs_base_texture(), is_needed);
    }
}
