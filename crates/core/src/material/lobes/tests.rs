use super::*;
use crate::bump::{NormalLayout, NormalMap};
use crate::codec::uastc::Effort;
use crate::image::{Image, Samples};
use crate::material::base::BaseRows;
use crate::material::bump_map::BumpMap;
use crate::material::rust_and_steel::{RustAndSteel, SIDE, is_steel};
use crate::metric::{Lobe, Precision, sample_sites};
use crate::mip::{Magnification, Wrap, level_sizes};

fn lobes<'a>(material: &'a RustAndSteel, has_reflectance: bool, settings: &Settings) -> Lobes<'a> {
    let bumps = Bumps::new(&material.bump_map, (SIDE, SIDE));
    Lobes::new(&material.base(has_reflectance), &bumps, 1.0, Sampler::default(), settings)
}

/// Returns the mean lobe errors of levels 4 and 5 against references of area x reflectance.
fn error(lobes: &Lobes<'_>, truth: &Lobes<'_>) -> f64 {
    let rows = |first, out: &mut [ReflectingLobe]| truth.reflecting_rows(first, out);
    let sites = sample_sites(&level_sizes(SIDE, SIDE), 4..6, Family::Ggx, Precision::QUICK, &rows);
    let errors = sites.iter().map(|site| {
        let mut row = vec![OrientedLobe::default(); (SIDE >> site.level) as usize];
        lobes.row(site.level, site.texel.1, &mut row);
        let OrientedLobe { normal, squared_alpha } = row[site.texel.0 as usize];
        let a = squared_alpha.0;
        site.reference.error(&Lobe::new(Family::Ggx, normal.map(f64::from), [a.uu, a.uv, a.vv].map(f64::from)))
    });
    errors.sum::<f64>() / sites.len() as f64
}

#[test]
fn merged_lobes_follow_the_metal_beside_rust() {
    let material = RustAndSteel::new();
    for quality in [Effort::Fast, Effort::Best] {
        let settings = Settings { quality, ..Settings::default() };
        let [by_area, by_reflectance] = [false, true].map(|has| lobes(&material, has, &settings));
        assert!(by_area.is_reflectance_constant() && !by_reflectance.is_reflectance_constant());
        let [area, reflectance] = [&by_area, &by_reflectance].map(|lobes| error(lobes, &by_reflectance));
        assert!(reflectance < 0.6 * area, "{quality:?}: {reflectance} {area}");
        let [rust, steel] =
            [&by_area, &by_reflectance].map(|lobes| lobes.coarsest().squared_alpha.closest_isotropic().0);
        assert!(steel < 0.5 * rust, "{quality:?}: {steel} {rust}");
    }
}

#[test]
fn every_reader_of_a_level_gives_the_same_lobes() {
    let material = RustAndSteel::new();
    let lobes = lobes(&material, true, &Settings::default());
    for (level, (width, height)) in level_sizes(SIDE, SIDE).into_iter().enumerate() {
        for y in 0..height {
            let mut row = vec![OrientedLobe::default(); width as usize];
            let (mut alphas, mut offsets) = (vec![SquaredAlpha::default(); row.len()], vec![[0.0; 2]; row.len()]);
            lobes.row(level, y, &mut row);
            lobes.squared_alphas(level, y, &mut alphas);
            lobes.offsets(level, y, &mut offsets);
            assert!(row.iter().zip(&alphas).all(|(lobe, alpha)| lobe.squared_alpha == *alpha));
            let is_near = |(lobe, [u, v]): (&OrientedLobe, &[f32; 2])| {
                let offset = lobe.offset();
                (offset.u - u).abs() < 1e-6 && (offset.v - v).abs() < 1e-6
            };
            assert!(row.iter().zip(&offsets).all(is_near));
        }
    }
    let mut last = [OrientedLobe::default()];
    lobes.row(6, 0, &mut last);
    assert_eq!(last, [lobes.coarsest()]);
}

#[test]
fn level_0_has_the_reflectance_of_its_texels() {
    let material = RustAndSteel::new();
    let lobes = lobes(&material, true, &Settings::default());
    let (mut row, mut texels) = ([OrientedLobe::default(); SIDE as usize], [ReflectingLobe::default(); SIDE as usize]);
    lobes.magnified_rows(1, &mut row);
    lobes.reflecting_rows(1, &mut texels);
    for (x, (lobe, texel)) in (0..).zip(row.iter().zip(&texels)) {
        assert_eq!(*lobe, texel.lobe);
        assert_eq!(is_steel(x, 1), texel.reflectance > 0.5, "{x}: {}", texel.reflectance);
    }
}

#[test]
fn resampling_keeps_what_a_sampler_interpolates() {
    // White noise of slopes has 4/9 of its variance where a sampler interpolates it.
    const SIDE: u32 = 65;
    let mut state = 1_u32;
    let mut component = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        100 + (56 * (state >> 24) / 256) as u8
    };
    let samples = (0..SIDE * SIDE).flat_map(|_| [component(), component(), 250]).collect();
    let image = Image { width: SIDE, height: SIDE, channels: 3, samples: Samples::U8(samples) };
    let bump_map = BumpMap::Normals(NormalMap::new(image, NormalLayout::Xyz, false).unwrap());
    let settings = Settings::default();
    let coarsest = |side, magnification| {
        let base = Base::new(BaseRows::new(side, side, None, 0.3, None, [Wrap::Repeat; 2]));
        let sampler = Sampler { magnification, ..Sampler::default() };
        let lobes = Lobes::new(&base, &Bumps::new(&bump_map, (side, side)), 1.0, sampler, &settings);
        lobes.coarsest().squared_alpha.0.trace()
    };
    let widening = |side, magnification| coarsest(side, magnification) - 2.0 * 0.3_f32.powi(4);
    let own = widening(SIDE, Magnification::Linear);
    for side in [64, 68, 128] {
        let linear = widening(side, Magnification::Linear);
        assert!((linear / own - 1.0).abs() < 0.05, "{side}: {linear} {own}");
        assert!(linear < 0.6 * widening(side, Magnification::Nearest), "{side}");
    }
}
