use super::*;
use crate::bump::{NormalLayout, NormalMap};
use crate::codec::uastc::Effort;
use crate::image::{Image, Rgba, Samples};
use crate::material::reflectance::{Factored, Metalness, ReflectanceRows, ReflectanceSource};
use crate::metric::{Lobe, Precision, sample_sites};
use crate::mip::{Wrap, level_sizes};

const SIDE: u32 = 64;

/// Returns an image whose texel (x, y) has the channels that `texel` returns.
fn image(texel: impl Fn(u32, u32) -> [u8; 3]) -> Image {
    let samples = (0..SIDE * SIDE).flat_map(|i| texel(i % SIDE, i / SIDE)).collect();
    Image { width: SIDE, height: SIDE, channels: 3, samples: Samples::U8(samples) }
}

/// Returns whether a texel is mirror steel. All others are rust.
fn is_steel(x: u32, y: u32) -> bool {
    (x / 8 + y / 8).is_multiple_of(2)
}

/// Rust with bumps beside mirror steel, which lies flat, in squares of eight texels.
struct RustAndSteel {
    bump_map: BumpMap,
    orm: Image,
    colour: Image,
}

impl RustAndSteel {
    fn new() -> Self {
        let slope = |x: u32, y: u32| [40 * (x % 2) as u8 + 20 * (y % 2) as u8, 50 * (y % 2) as u8];
        let normal = |x, y| {
            let [u, v] = if is_steel(x, y) { [0, 0] } else { slope(x, y) };
            [128 + u, 100 + v, 220]
        };
        let normals = NormalMap::new(image(normal), NormalLayout::Xyz, false).unwrap();
        Self {
            bump_map: BumpMap::Normals(normals),
            orm: image(|x, y| if is_steel(x, y) { [255, 40, 255] } else { [255, 200, 0] }),
            colour: image(|x, y| if is_steel(x, y) { [200, 200, 200] } else { [90, 40, 20] }),
        }
    }

    /// Returns the base lobe, with or without its reflectance.
    fn base(&self, has_reflectance: bool) -> Base<'_> {
        let wrap = [Wrap::Repeat; 2];
        let source = ReflectanceSource {
            roughness: Some(&self.orm),
            metalness: Metalness::new(Some(&self.orm), 1.0),
            base_colour: Factored { image: Some(&self.colour), factor: [1.0; 3] },
            specular: Factored { image: None, factor: 1.0 },
            specular_colour: Factored { image: None, factor: [1.0; 3] },
        };
        let reflectance = ReflectanceRows::new(&source, (SIDE, SIDE), wrap).filter(|_| has_reflectance);
        let rows = BaseRows::new(SIDE, SIDE, Some(Rgba(&self.orm)), 1.0, None, wrap);
        Base::new(rows.with_reflectance(reflectance))
    }

    fn lobes(&self, has_reflectance: bool, settings: &Settings) -> Lobes<'_> {
        let bumps = Bumps::new(&self.bump_map, (SIDE, SIDE));
        Lobes::new(&self.base(has_reflectance), &bumps, 1.0, Sampler::default(), settings)
    }
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
        let [by_area, by_reflectance] = [false, true].map(|has| material.lobes(has, &settings));
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
    let lobes = material.lobes(true, &Settings::default());
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
    let lobes = material.lobes(true, &Settings::default());
    let (mut row, mut texels) = ([OrientedLobe::default(); SIDE as usize], [ReflectingLobe::default(); SIDE as usize]);
    lobes.magnified_rows(1, &mut row);
    lobes.reflecting_rows(1, &mut texels);
    for (x, (lobe, texel)) in (0..).zip(row.iter().zip(&texels)) {
        assert_eq!(*lobe, texel.lobe);
        assert_eq!(is_steel(x, 1), texel.reflectance > 0.5, "{x}: {}", texel.reflectance);
    }
}
