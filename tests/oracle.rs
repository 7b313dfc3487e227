//! Compares decoded levels of bakes with a slow f64 oracle, which shares only the table of corrections with the bake.

use std::path::Path;

use roughcast::bake::{BaseRoughness, bake_map};
use roughcast::bump::{Moments, NormalLayout, NormalMap, Offset, Outliers, ShapedMoments};
use roughcast::codec::Target;
use roughcast::decode::decode;
use roughcast::image::{DecodeOptions, Image, Samples};
use roughcast::ktx2;
use roughcast::ktx2::Ktx2;
use roughcast::lobe::{Distribution, Family, SquaredAlpha};
use roughcast::material::BumpMap;
use roughcast::math::symmetric::Symmetric2;
use roughcast::report::Content;
use roughcast::settings::{Model, Settings};

#[path = "common/skip.rs"]
mod skip;

/// Returns 128 x 128 texels of brushed metal with a few dents. All arithmetic is on integers, so that every machine
/// gives equal texels.
fn synthetic() -> Image {
    let mut state = 1u32;
    let mut random = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        i32::from((state >> 24) as u8) - 128
    };
    let scratches: Vec<i32> = (0..128).map(|_| random() / 3).collect();
    let texel = |i: i32| {
        let (x, y) = (i % 128, i / 128);
        let dent = if (x / 16 + y / 16) % 5 == 0 { 20 } else { 0 };
        let (nx, ny) = (dent, scratches[y as usize] + random() / 16);
        let nz = f64::from(127 * 127 - nx * nx - ny * ny).sqrt() as i32;
        [nx, ny, nz].map(|n| (n + 128) as u8)
    };
    let samples = (0..128 * 128).flat_map(texel).collect();
    Image { width: 128, height: 128, channels: 3, samples: Samples::U8(samples) }
}

/// Returns the image `name` of `../shared/data/FlightHelmet`, if it exists.
fn real(name: &str) -> Option<Image> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/FlightHelmet");
    let file = std::fs::read(folder.join(format!("FlightHelmet_Materials_{name}.png"))).ok()?;
    Some(decode(&file, &DecodeOptions::default()).unwrap())
}

/// Expected values of a texel: unit normal, then A' (uu, uv, vv).
struct Expected {
    normal: [f64; 3],
    squared_alpha: [f64; 3],
}

/// Returns the unit normal of a texel of a map that repeats.
fn unit_normal(normals: &Image, x: i64, y: i64) -> [f64; 3] {
    let [x, y] = [x.rem_euclid(i64::from(normals.width)), y.rem_euclid(i64::from(normals.height))].map(|i| i as u32);
    let n = [0, 1, 2].map(|c| 2.0 * f64::from(normals.sample(x, y, c).unwrap()) - 1.0);
    let length = n.iter().map(|c| c * c).sum::<f64>().sqrt();
    n.map(|c| c / length)
}

/// Returns the slopes that a sampler shows within a texel: at four points at a distance of 1/2 - 1/sqrt 12 from its
/// centre along both axes.
fn magnified_slopes(normals: &Image, (x, y): (u32, u32)) -> [[f64; 2]; 4] {
    let share = 0.5 - 1.0 / 12.0_f64.sqrt();
    [(-1, -1), (1, -1), (-1, 1), (1, 1)].map(|(dx, dy)| {
        let (x, y) = (i64::from(x), i64::from(y));
        let [here, beside, below, across] =
            [(0, 0), (dx, 0), (0, dy), (dx, dy)].map(|(i, j)| unit_normal(normals, x + i, y + j));
        let mix = |c: usize| {
            (1.0 - share) * ((1.0 - share) * here[c] + share * beside[c])
                + share * ((1.0 - share) * below[c] + share * across[c])
        };
        let [nx, ny, nz] = [mix(0), mix(1), mix(2)];
        [-nx / nz, -ny / nz]
    })
}

/// Computes a texel directly from its level-0 texels, and at level 0 from the texel. Levels for which `is_base` holds
/// have the base lobe of the mean roughness; the others have the mean squared alphas, widened by the bumps. The
/// sides of the map are powers of two.
fn oracle(normals: &Image, base: &BaseRoughness, is_base: bool, level: u32, (x, y): (u32, u32)) -> Expected {
    let side = 1 << level;
    let texels: Vec<(u32, u32)> = (0..side * side).map(|i| (x * side + i % side, y * side + i / side)).collect();
    let slopes: Vec<[f64; 2]> = if level == 0 {
        let [nx, ny, nz] = unit_normal(normals, x.into(), y.into());
        vec![[-nx / nz, -ny / nz]]
    } else {
        texels.iter().flat_map(|texel| magnified_slopes(normals, *texel)).collect()
    };
    let count = slopes.len() as f64;
    let mean = [0, 1].map(|i| slopes.iter().map(|s| s[i]).sum::<f64>() / count);
    let k = |i: usize, j: usize| slopes.iter().map(|s| (s[i] - mean[i]) * (s[j] - mean[j])).sum::<f64>() / count;
    let roughness_of = |&(x, y): &(u32, u32)| {
        let green = base.image.as_ref().map_or(1.0, |r| f64::from(r.sample(x, y, 1).unwrap()));
        f64::from(base.factor) * green
    };
    let mean_of =
        |power: i32| texels.iter().map(|texel| roughness_of(texel).powi(power)).sum::<f64>() / texels.len() as f64;
    let base = if is_base { mean_of(1).powi(4) } else { mean_of(4) };
    let covariance = Symmetric2::new(k(0, 0) as f32, k(0, 1) as f32, k(1, 1) as f32);
    let base_lobe = SquaredAlpha(Symmetric2::diagonal(base as f32, base as f32));
    let moments = ShapedMoments::normal(Moments { mean: Offset::default(), covariance });
    let corrected = Distribution::Normal.correct(&moments, base_lobe, Family::Ggx).covariance;
    let lobe = if is_base { base_lobe.0 } else { base_lobe.roughen(corrected).0 };
    let length = (mean[0] * mean[0] + mean[1] * mean[1] + 1.0).sqrt();
    Expected {
        normal: [-mean[0] / length, -mean[1] / length, 1.0 / length],
        squared_alpha: [lobe.uu, lobe.uv, lobe.vv].map(f64::from),
    }
}

/// Largest and mean errors over the texels of a level.
#[derive(Default)]
struct Errors {
    count: f64,
    angle: f64,
    alpha: f64,
}

/// Compares levels 0 to 6. The bounds are the mean angle between normals in degrees and the mean difference of the two
/// alphas, which are A' projected on the baked axes.
fn compare(normals: Image, roughness: Option<Image>, factor: f32, target: Target, bounds: (f64, f64)) {
    let bump_map = BumpMap::Normals(NormalMap::new(normals.clone(), NormalLayout::Xyz, false).unwrap());
    let settings =
        Settings::default().with_model(Model::Anisotropic).with_distribution(Distribution::Normal).with_target(target);
    let base = BaseRoughness { image: roughness, factor };
    let baked = bake_map(&bump_map, Some(&base), &settings).unwrap();
    // Levels at which the roughened lobes have a larger error keep the base lobe.
    let base_levels = &baked.choice.as_ref().and_then(|choice| choice.taken()).expect("a choice").base_levels;
    assert_eq!(bump_map.outliers(), Outliers::default());
    let contents: Vec<Content> = baked.textures.iter().map(|t| t.content).collect();
    assert_eq!(contents, [Content::Normal, Content::Roughness, Content::Anisotropy]);
    let files: Vec<Vec<u8>> = baked.textures.iter().map(|t| t.mip_chain.to_ktx2(&[]).unwrap()).collect();
    for level in 0..=6 {
        let [normal, surface, axes] =
            [0, 1, 2].map(|t| ktx2::Ktx2::decode_level(&Ktx2::parse(&files[t]).unwrap(), level).unwrap());
        let mut errors = Errors::default();
        for i in 0..normal.width * normal.height {
            let (x, y) = (i % normal.width, i / normal.width);
            let expected = oracle(&normals, &base, base_levels.contains(&(level as usize)), level, (x, y));
            let at = |image: &Image, c| f64::from(image.sample(x, y, c).unwrap());
            let n = [0, 1, 2].map(|c| 2.0 * at(&normal, c) - 1.0);
            let length = n.iter().map(|n| n * n).sum::<f64>().sqrt();
            let cos = n.iter().zip(expected.normal).map(|(a, b)| a * b).sum::<f64>() / length;
            let across = at(&surface, 1).powi(2);
            let along = across + (1.0 - across) * at(&axes, 2).powi(2);
            let d = [2.0 * at(&axes, 0) - 1.0, 2.0 * at(&axes, 1) - 1.0];
            let length = (d[0] * d[0] + d[1] * d[1]).sqrt().max(1e-9);
            let d = d.map(|d| d / length);
            let [uu, uv, vv] = expected.squared_alpha;
            let project = |[x, y]: [f64; 2]| (uu * x * x + 2.0 * uv * x * y + vv * y * y).max(0.0).sqrt().min(1.0);
            errors.count += 1.0;
            errors.angle += cos.min(1.0).acos().to_degrees();
            errors.alpha += 0.5 * ((along - project(d)).abs() + (across - project([-d[1], d[0]])).abs());
        }
        let (angle, alpha) = (errors.angle / errors.count, errors.alpha / errors.count);
        assert!(angle < bounds.0 && alpha < bounds.1, "level {level}: {angle:.3} degrees, alpha {alpha:.4}");
    }
}

/// Half floats keep ten bits, so that the bounds are those of the mathematics.
#[test]
fn levels_match_the_oracle_in_floats() {
    compare(synthetic(), None, 0.4, Target::Float, (0.05, 5e-4));
}

#[test]
fn levels_match_the_oracle_in_uastc() {
    compare(synthetic(), None, 0.4, Target::Basis, (0.9, 0.003));
}

#[test]
fn levels_of_a_real_material_match_the_oracle() {
    let (Some(normals), Some(roughness)) =
        (real("GlassPlasticMat_Normal"), real("GlassPlasticMat_OcclusionRoughMetal"))
    else {
        return skip::skip("../shared/data/FlightHelmet does not exist");
    };
    compare(normals.clone(), Some(roughness.clone()), 1.0, Target::Float, (0.05, 1e-3));
    compare(normals, Some(roughness), 1.0, Target::Basis, (0.9, 0.025));
}
