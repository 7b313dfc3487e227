use crate::bake::{BaseRoughness, EncodedMap, bake_map};
use crate::bump::{NormalLayout, NormalMap};
use crate::codec::Target;
use crate::image::{Image, Samples};
use crate::ktx2::Ktx2;
use crate::lobe::{Alpha, Family, Roughness, SquaredAlpha};
use crate::material::{Base, BaseRows, BumpMap, Bumps, Normals, Roughening};
use crate::metric::{Decoded, Lobe, Reference, SAMPLES, Surface, mean_errors, sample_texels};
use crate::mip::{Sampler, Wrap};
use crate::report::{Candidate, Content, Miss, Reason};
use crate::select::evaluate::*;
use crate::settings::{Profile, Settings};

/// Returns a normal map of `side` x `side` texels with these slopes.
fn normals(side: u32, slope: impl Fn(u32, u32) -> [f32; 2]) -> Image {
    let texel = |i: u32| {
        let [u, v] = slope(i % side, i / side);
        let length = (1.0 + u * u + v * v).sqrt();
        [-u / length, -v / length, 1.0 / length].map(|c| 0.5 * c + 0.5)
    };
    let samples = (0..side * side).flat_map(texel).collect();
    Image { width: side, height: side, channels: 3, samples: Samples::F32(samples) }
}

/// Returns pseudo-random numbers in [-1, 1], nearly normally distributed with deviation 1/2.
fn noise(x: u32, y: u32, seed: u32) -> f32 {
    let mut state = x.wrapping_mul(0x9e37_79b9) ^ y.wrapping_mul(0x85eb_ca6b) ^ seed.wrapping_mul(0xc2b2_ae35);
    let mut sum = 0.0;
    for _ in 0..4 {
        state = (state ^ (state >> 15)).wrapping_mul(0x2c1b_3c6d);
        state = (state ^ (state >> 12)).wrapping_mul(0x297a_2d39);
        state ^= state >> 15;
        sum += (state >> 8) as f32 / (1 << 23) as f32 - 1.0;
    }
    0.25 * sum
}

fn rough_noise(x: u32, y: u32) -> [f32; 2] {
    [0.5 * noise(x, y, 1), 0.5 * noise(x, y, 2)]
}

fn brushed(x: u32, y: u32) -> [f32; 2] {
    [0.02 * noise(x, y, 1), 0.6 * noise(0, y, 2)]
}

fn bake(image: &Image, roughness: f32, settings: &Settings) -> EncodedMap {
    bake_with(image, BaseRoughness { image: None, factor: roughness }, settings)
}

fn bake_with(image: &Image, base: BaseRoughness, settings: &Settings) -> EncodedMap {
    let map = NormalMap::new(image.clone(), NormalLayout::Xyz, false).unwrap();
    bake_map(&BumpMap::Normals(map), Some(&base), settings).unwrap()
}

fn choice_of(image: &Image, roughness: f32, settings: &Settings) -> Choice {
    bake(image, roughness, settings).choice.unwrap()
}

fn settings(max_error: f32) -> Settings {
    Settings { max_error, ..Settings::default() }
}

fn taken(choice: &Choice) -> (Model, usize) {
    let taken = choice.taken().unwrap();
    (taken.model, taken.first)
}

#[test]
fn flat_maps_and_matt_materials_need_no_model() {
    let flat = choice_of(&normals(64, |_, _| [0.0; 2]), 0.7, &settings(0.01));
    assert_eq!((taken(&flat), flat.misses.len()), ((Model::None, 0), 0));
    assert!(flat.candidates[0].errors.iter().all(|e| *e < 0.008), "{:?}", flat.candidates[0]);
    assert_eq!(flat.candidates[0].bytes, 0);
    assert_eq!(taken(&choice_of(&normals(64, rough_noise), 1.0, &settings(0.1))).0, Model::None);
}

#[test]
fn brushed_metal_needs_the_anisotropic_model_and_noise_the_isotropic_model() {
    let metal = choice_of(&normals(64, brushed), 0.4, &settings(0.09));
    assert_eq!(taken(&metal).0, Model::Anisotropic, "{metal:#?}");
    let noise = choice_of(&normals(64, rough_noise), 0.4, &settings(0.12));
    assert_eq!(taken(&noise).0, Model::Isotropic, "{noise:#?}");
    // The blocks of normals of level 0 cannot hold noise.
    let is_limit = |miss: &Miss| (miss.level, &miss.reason) == (0, &Reason::Encoding);
    assert!(noise.misses.iter().all(is_limit), "{noise:#?}");
}

/// Cost is shader work, then bytes: none, then isotropic from small to large, then anisotropic.
#[test]
fn candidates_rise_in_cost() {
    let choice = choice_of(&normals(64, brushed), 0.2, &settings(0.1));
    let order: Vec<_> = choice.candidates.iter().map(|c| (c.model, c.first)).collect();
    let of = |model| [(model, 2), (model, 1), (model, 0)];
    let expected = [&[(Model::None, 0)][..], &of(Model::Isotropic), &of(Model::Anisotropic)].concat();
    assert_eq!(order, expected);
    for pair in choice.candidates.windows(2) {
        assert!((pair[0].model, pair[0].bytes) < (pair[1].model, pair[1].bytes), "{pair:?}");
    }
    // 64 x 64 down to 1 x 1: 256 + 64 + 16 + 4 + 1 + 1 + 1 blocks of 16 bytes.
    assert_eq!(choice.candidates[3].bytes, 343 * 16);
}

#[test]
fn smaller_textures_have_the_blocks_of_the_full_size() {
    // Bumps two texels wide: the levels from 1 on have lost all there is to lose, and level 0 has as much everywhere
    // within a texel as anywhere. Rough enough that level 0 does not care.
    let checks = normals(64, |x, y| if (x / 8 + y / 8) % 2 == 0 { [0.06, 0.0] } else { [-0.06, 0.0] });
    let choice = choice_of(&checks, 0.6, &settings(0.05));
    let at = |model, first| choice.candidates.iter().find(|c| (c.model, c.first) == (model, first)).unwrap();
    // At levels that the smaller texture has, it holds equal blocks.
    for model in [Model::Isotropic, Model::Anisotropic] {
        for first in [1, 2] {
            assert_eq!(at(model, first).errors[first..], at(model, 0).errors[first..]);
            assert!(at(model, first).bytes < at(model, first - 1).bytes / 3);
        }
    }
    let all = settings(1.0);
    assert_eq!(taken(&choice_of(&checks, 0.6, &all)), (Model::None, 0));
}

#[test]
fn bakes_the_chosen_size() {
    // Noise of the finest grain: roughness is the same everywhere from level 1 on, and a little at level 0 is allowed.
    let image = normals(64, |x, y| [0.3 * noise(x, y, 1), 0.3 * noise(x, y, 2)]);
    let baked = bake(&image, 0.4, &settings(0.06));
    let choice = baked.choice.as_ref().unwrap();
    let (model, first) = taken(choice);
    assert!(model == Model::Isotropic && first > 0, "{choice:#?}");
    let roughness = baked.textures.iter().find(|t| t.content == Content::Roughness).unwrap();
    assert_eq!((roughness.mip_chain.width, roughness.mip_chain.trimmed), (64 >> first, first));
    // With a fixed model nothing is saved.
    let fixed = bake(&image, 0.4, &Settings { model: Model::Isotropic, ..settings(0.06) });
    assert_eq!(fixed.textures[1].mip_chain.width, 64);
}

/// A smaller texture would also lose a level of metalness and occlusion.
#[test]
fn textures_with_other_data_keep_their_size() {
    let base = |blue: &dyn Fn(u32) -> u8| {
        let samples = (0..64 * 64).flat_map(|i| [255, 80, blue(i)]).collect();
        BaseRoughness {
            image: Some(Image { width: 64, height: 64, channels: 3, samples: Samples::U8(samples) }),
            factor: 1.0,
        }
    };
    let image = normals(64, |x, y| [0.3 * noise(x, y, 1), 0.3 * noise(x, y, 2)]);
    let plain = bake_with(&image, base(&|_| 255), &settings(0.13)).choice.unwrap();
    let mixed = bake_with(&image, base(&|i| if i % 7 == 0 { 0 } else { 255 }), &settings(0.13)).choice.unwrap();
    assert!(plain.candidates.iter().any(|c| c.first > 0));
    assert!(mixed.candidates.iter().all(|c| c.first == 0));
}

/// Compares the errors at the sample points with the errors of all texels of the baked files.
#[test]
fn errors_are_those_of_the_baked_files() {
    for (slope, target, family) in [
        (brushed as fn(u32, u32) -> [f32; 2], Target::Basis, Family::Ggx),
        (rough_noise, Target::Float, Family::Beckmann),
        #[cfg(feature = "bc")]
        (brushed, Target::Bc, Family::Ggx),
    ] {
        let image = normals(64, slope);
        let settings = Settings { model: Model::Anisotropic, target, lobe: family, ..settings(0.1) };
        let baked = bake(&image, 0.4, &settings);
        let choice = baked.choice.as_ref().unwrap();
        let map = NormalMap::new(image, NormalLayout::Xyz, false).unwrap();
        let texels = Surface::of_map(&map, SquaredAlpha::isotropic(Alpha::from(Roughness(0.4))));
        let magnified = texels.magnified();
        for (level, found) in choice.taken().unwrap().errors.iter().enumerate() {
            let size = (64 >> level, 64 >> level);
            let of = |content| {
                let mip_chain = &baked.textures.iter().find(|t| t.content == content).unwrap().mip_chain;
                Ktx2::parse(&mip_chain.to_ktx2(&[]).unwrap()).unwrap().decode_level(level as u32).unwrap()
            };
            let decoded = Decoded {
                normal: of(Content::Normal),
                roughness: Some(of(Content::Roughness)),
                roughness_factor: 1.0,
                anisotropy: Some(of(Content::Anisotropy)),
            };
            let surface = if level == 0 { &texels } else { &magnified };
            let [full] = mean_errors(surface, family, size, &sample_texels(size, 128), |(x, y), _, reference| {
                [reference.error(&decoded.lobe(family, x, y).unwrap())]
            });
            assert!((f64::from(*found) - full).abs() < 0.015, "{target:?}, level {level}: {found} {full}");
        }
    }
}

/// A smaller texture is no choice if the base lobe is better at its first level or at a level that it lacks, whatever
/// the bound.
#[test]
fn smaller_textures_lose_little_against_the_base_lobe() {
    // Noise of the finest grain: level 0 has lost nothing, and all other levels have lost as much.
    let image = normals(64, |x, y| [0.3 * noise(x, y, 1), 0.3 * noise(x, y, 2)]);
    let mut is_passed_over = false;
    for step in 1..=10 {
        let max_error = 0.05 * step as f32;
        let choice = choice_of(&image, 0.3, &Settings { target: Target::Float, ..settings(max_error) });
        let (none, taken) = (&choice.candidates[0], choice.taken().unwrap());
        let loses = |c: &Candidate| (0..=c.first).any(|level| c.errors[level] > none.errors[level] + 0.005);
        assert!(!loses(taken), "{max_error}: {choice:#?}");
        let cheaper = &choice.candidates[..choice.chosen];
        is_passed_over |= cheaper.iter().any(|c| loses(c) && c.errors.iter().all(|error| *error <= max_error));
    }
    assert!(is_passed_over, "no bound tempts to take a smaller texture");
}

/// A mirror of 128 x 128 texels with four steep texels in each 16 x 16: they widen the range of D, so that a small K is
/// lost in the encoding.
fn mirror_with_sparks() -> (Image, BaseRoughness) {
    let size = |x: u32, y: u32| if x % 16 < 2 && y % 16 < 2 { 6.0 } else { 0.005 };
    let image = normals(128, |x, y| [size(x, y) * noise(x, y, 1), size(x, y) * noise(x, y, 2)]);
    (image, BaseRoughness { image: None, factor: 0.06 })
}

/// Finer levels are magnified from the first level of a smaller texture, so that this level keeps its lobes.
#[test]
fn the_first_level_of_a_smaller_texture_keeps_its_lobes() {
    let (image, base) = mirror_with_sparks();
    let choice = bake_with(&image, base, &Settings { profile: Profile::Pyramid, ..settings(0.1) }).choice.unwrap();
    let keeps = |model, first, level: usize| {
        let candidate = choice.candidates.iter().find(|c| (c.model, c.first) == (model, first)).unwrap();
        candidate.base_levels.contains(&level)
    };
    let is_spared = |model| {
        assert!((1..=2).all(|first| !keeps(model, first, first)), "{choice:#?}");
        (1..=2).any(|level| keeps(model, 0, level))
    };
    let spared = [Model::Isotropic, Model::Anisotropic].map(is_spared);
    assert!(spared.contains(&true), "the full size keeps the base lobe at none of these levels: {choice:#?}");
}

/// K is 0 at a level that the base lobe shows better.
#[test]
fn levels_of_the_pyramid_are_no_worse_than_the_base_lobe() {
    let (image, base) = mirror_with_sparks();
    let settings = Settings { profile: Profile::Pyramid, model: Model::Anisotropic, ..settings(0.1) };
    let baked = bake_with(&image, base, &settings);
    let choice = baked.choice.as_ref().unwrap();
    let (none, taken) = (&choice.candidates[0], choice.taken().unwrap());
    let factor = baked.textures.iter().find(|t| t.content == Content::Factor).unwrap();
    for level in 1..none.errors.len() {
        assert!(taken.errors[level] <= none.errors[level] + 0.005, "level {level}: {taken:?} {none:?}");
        let ktx2 = factor.mip_chain.to_ktx2(&[]).unwrap();
        let image = Ktx2::parse(&ktx2).unwrap().decode_level(level as u32).unwrap();
        let range = factor.range.as_ref().unwrap();
        let texels = (0..image.height).flat_map(|y| (0..image.width).map(move |x| (x, y)));
        let largest = texels.flat_map(|(x, y)| {
            let [r, g, b] = [0, 1, 2].map(|c| image.sample(x, y, c).unwrap());
            range.values::<3>([r, g, b, 1.0])
        });
        let largest = largest.fold(0.0_f32, |largest, d: f32| largest.max(d.abs()));
        assert!(!taken.base_levels.contains(&level) || largest < 0.01, "level {level}: {largest}");
    }
    assert!(!taken.base_levels.is_empty(), "{choice:#?}");
}

#[test]
fn the_error_of_both_profiles_is_the_larger_one() {
    let image = normals(64, brushed);
    let of = |profile| choice_of(&image, 0.4, &Settings { profile, model: Model::Anisotropic, ..settings(0.1) });
    let [portable, pyramid, both] = [Profile::Portable, Profile::Pyramid, Profile::Both].map(of);
    for (i, candidate) in both.candidates.iter().enumerate() {
        for (level, error) in candidate.errors.iter().enumerate() {
            let (a, b) = (portable.candidates[i].errors[level], pyramid.candidates[i].errors[level]);
            // The mean of the larger is not less than the larger of the means.
            assert!(*error >= a.max(b) - 1e-4 && *error <= a + b + 1e-4, "{i} {level}: {error} {a} {b}");
        }
        assert_eq!(candidate.bytes, portable.candidates[i].bytes + pyramid.candidates[i].bytes);
    }
}

#[test]
fn distinguishes_two_peaks_from_too_simple_a_model() {
    // V-grooves: half of the texels lean one way, half the other; no lobe covers both.
    let grooves = choice_of(
        &normals(64, |x, _| if x % 2 == 0 { [0.5, 0.0] } else { [-0.5, 0.0] }),
        0.3,
        &Settings { target: Target::Float, ..settings(0.1) },
    );
    assert!(!grooves.misses.is_empty());
    assert!(grooves.misses.iter().all(|m| m.reason == Reason::TwoPeaked), "{:#?}", grooves.misses);
    let note = grooves.note(&settings(0.1)).unwrap();
    assert!(
        note.text.starts_with("levels 1-6 miss --max-error 0.1") && note.text.ends_with("which one lobe cannot show"),
        "{note}"
    );
    // The model none was requested, and a single lobe would meet the bound.
    let none = choice_of(&normals(64, rough_noise), 0.4, &Settings { model: Model::None, ..settings(0.1) });
    assert!(!none.misses.is_empty());
    assert!(none.misses.iter().all(|m| m.level == 0 || m.reason == Reason::Fit), "{:#?}", none.misses);
    assert_eq!((none.misses[0].level, none.misses[0].reason), (0, Reason::Encoding));
}

/// Calls `f` with the candidates of a material whose finest level that can be sampled is the given one.
fn with_candidates<T>(side: u32, slope: fn(u32, u32) -> [f32; 2], finest: usize, f: impl Fn(&CandidateSet) -> T) -> T {
    let map = NormalMap::new(normals(side, slope), NormalLayout::Xyz, false).unwrap();
    let bump_map = BumpMap::Normals(map);
    let bumps = Bumps::new(&bump_map, (side, side));
    let base = Base::new(BaseRows::new(side, side, None, 0.4, None, [Wrap::Repeat; 2]));
    let settings = settings(0.1);
    let roughening = Roughening::new(base, &bumps, 1.0, Sampler::default(), &settings);
    let normals = Normals::of_lobes(&bumps, roughening.lobes());
    f(&CandidateSet {
        roughening: &roughening,
        settings: &settings,
        normals: Some(&normals),
        pyramid: None,
        wrap: [Wrap::Repeat; 2],
        max_model: Model::Anisotropic,
        finest,
        first: 0,
    })
}

/// Bumps of many sizes, some steep: texels of a level differ much from each other.
fn uneven(x: u32, y: u32) -> [f32; 2] {
    let waves = |u: f32, v: f32| (0.05 * u).sin() * (0.031 * v + 1.0).cos() + (0.4 * u + 0.13 * v).sin();
    let steep = if noise(x / 24, y / 24, 3) > 0.4 { 1.0 } else { 0.1 };
    [steep * waves(x as f32, y as f32), 0.3 * steep * noise(x, y, 4)]
}

/// The errors of a default bake, which counts some texels, are within 0.01 of those of all texels.
#[test]
fn errors_are_those_of_all_texels() {
    let all =
        Precision { texels: usize::MAX, least: usize::MAX, rows: usize::MAX, level0: u32::MAX, half_vectors: 1 << 19 };
    for slope in [uneven, brushed] {
        with_candidates(256, slope, 0, |set| {
            let (quick, all) = (set.choose_with(Precision::QUICK).unwrap(), set.choose_with(all).unwrap());
            let pairs = quick.candidates.iter().zip(&all.candidates);
            for (quick, all) in pairs {
                assert_eq!((quick.model, quick.first), (all.model, all.first));
                for (level, (quick, all)) in quick.errors.iter().zip(&all.errors).enumerate() {
                    assert!((quick - all).abs() < 0.01, "level {level}: {quick} {all}");
                }
            }
        });
    }
}

#[test]
fn levels_that_cannot_be_sampled_do_not_count() {
    let choice = |finest| with_candidates(64, brushed, finest, |set| set.choose().unwrap());
    let [all, coarse] = [0, 3].map(choice);
    assert_eq!((all.finest, coarse.finest), (0, 3));
    for candidate in &coarse.candidates {
        let same = all.candidates.iter().find(|c| (c.model, c.first) == (candidate.model, candidate.first)).unwrap();
        assert_eq!(candidate.errors, same.errors[3..]);
    }
    // A quarter of the size lacks nothing that is sampled.
    assert_eq!(taken(&coarse).1, 2);
    assert_eq!(choice(99).finest, 6, "there is always one level");
}

/// A texture that takes the place of the material's own costs nothing, so that it is preferred to no model. It is not
/// where it hardly changes the picture: a flat surface needs no other roughness than the mean.
#[test]
fn a_roughness_texture_that_replaces_another_costs_nothing() {
    let roughness = |channel: fn(u32) -> u32| {
        let samples = Samples::U8((0..64 * 64).flat_map(|i| [0, channel(i) as u8, 255]).collect());
        BaseRoughness { image: Some(Image { width: 64, height: 64, channels: 3, samples }), factor: 1.0 }
    };
    let bumpy = normals(64, |x, y| [0.3 * noise(x, y, 1), 0.3 * noise(x, y, 2)]);
    let flat = normals(64, |_, _| [0.0; 2]);
    let chosen = |image: &Image, base: BaseRoughness, profile| {
        let choice = bake_with(image, base, &Settings { profile, ..settings(0.3) }).choice.unwrap();
        let none = &choice.candidates[0];
        assert!(none.errors.iter().all(|error| *error <= 0.3), "{choice:#?}");
        choice.taken().unwrap().model
    };
    let constant = |factor| BaseRoughness { image: None, factor };
    assert_eq!(chosen(&bumpy, roughness(|_| 120), Profile::Portable), Model::Isotropic);
    assert_eq!(chosen(&bumpy, roughness(|_| 120), Profile::Pyramid), Model::None, "D would be one more texture");
    assert_eq!(chosen(&bumpy, constant(120.0 / 255.0), Profile::Portable), Model::None);
    assert_eq!(chosen(&flat, roughness(|i| 150 + i % 3), Profile::Portable), Model::None);
    let samples = Samples::U8([0, 120, 255].repeat(4 * 4));
    let small = BaseRoughness { image: Some(Image { width: 4, height: 4, channels: 3, samples }), factor: 1.0 };
    assert_eq!(chosen(&bumpy, small, Profile::Portable), Model::None, "the texture would be larger");
}

/// Without a model, engines show mips of the material's own roughness texture: the mean roughness, and not the mean of
/// squared alphas, which is further from the truth on a flat surface.
#[test]
fn the_base_lobe_has_the_mean_roughness() {
    const SIDE: u32 = 64;
    let channel = |i: u32| if noise(i % SIDE / 8, i / SIDE / 8, 9) < 0.0 { 60 } else { 150_u8 };
    let samples = Samples::U8((0..SIDE * SIDE).flat_map(|i| [0, channel(i), 255]).collect());
    let image = Image { width: SIDE, height: SIDE, channels: 3, samples };
    let base = BaseRoughness { image: Some(image), factor: 1.0 };
    let settings = Settings { target: Target::Float, ..settings(0.5) };
    let choice = bake_with(&normals(SIDE, |_, _| [0.0; 2]), base, &settings).choice.unwrap();
    let squared_alpha = |i: u32| SquaredAlpha::isotropic(Roughness(f32::from(channel(i)) / 255.0).into());
    let lobes: Vec<SquaredAlpha> = (0..SIDE * SIDE).map(squared_alpha).collect();
    let surface = Surface::new(SIDE, SIDE, &vec![[0.0, 0.0, 1.0]; lobes.len()], &lobes).unwrap();
    let truth = surface.magnified();
    for level in 4..=6 {
        let size = (SIDE >> level, SIDE >> level);
        let texels = (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y)));
        let errors = texels.map(|texel| {
            let footprint = surface.footprint(size, texel);
            let mean = |of: fn(f64) -> f64| footprint.parts().iter().map(|p| p.weight * of(p.base[0])).sum::<f64>();
            let reference = Reference::new(Family::Ggx, &truth.footprint(size, texel), SAMPLES);
            let lobe = |a: f64| Lobe::new(Family::Ggx, [0.0, 0.0, 1.0], [a, 0.0, a]);
            [mean(|a| a.sqrt().sqrt()).powi(4), mean(|a| a)].map(|a| reference.error(&lobe(a)))
        });
        let errors: Vec<[f64; 2]> = errors.collect();
        let [of_roughness, of_squares] = [0, 1].map(|i| errors.iter().map(|e| e[i]).sum::<f64>() / errors.len() as f64);
        let shown = f64::from(choice.candidates[0].errors[level]);
        assert!((shown - of_roughness).abs() < 0.01, "level {level}: {shown} {of_roughness}");
        assert!(of_squares > of_roughness + 0.02, "level {level}: {of_squares} {of_roughness}");
    }
}
