//! Tests of the whole renderer against known results.

use super::*;
use crate::math::vector::{Vector, dot, normalised};
use crate::mip::Level;

const METAL: Shader = Shader { reflection: Reflection::Ggx, filter: EnvironmentFilter::Ellipse, f0: 0.9 };

/// Returns a plane under a lamp, `width` x `width` pixels.
fn scene(width: u32, surroundings: Surroundings) -> Scene {
    Scene {
        shape: Shape::Plane { repeats: 1.0 },
        camera: Camera::new([0.0, 0.0, 1.0], [0.0, 1.0, 0.4], 0.3, [width, width]),
        light: Some(Light::Point { position: [0.3, 3.0, 1.5], intensity: 5.0 }),
        environment: Environment::new(surroundings),
        f0: 0.9,
        key: 0.2,
    }
}

fn flat(roughness: f64) -> Material {
    Material {
        bumps: Bumps::Flat,
        roughness: None,
        roughness_factor: roughness,
        anisotropy: None,
        lost: LostBumps::RoughenedTextures,
    }
}

/// Returns a material with a constant, tilted normal map of 4 x 4 texels.
fn tilted(roughness: f64) -> Material {
    let texel = normalised([0.2, -0.1, 1.0]).map(|c| (0.5 * c + 0.5) as f32);
    let texels = vec![[texel[0], texel[1], texel[2], 1.0]; 16];
    let texture = Texture::with_mips(Level { width: 4, height: 4, texels });
    Material { bumps: Bumps::Normals { texture, scale: 1.0, has_z: true }, ..flat(roughness) }
}

fn error(scene: &Scene, material: &Material, shader: &Shader, truth: &Material, samples: u32) -> f64 {
    let truth = supersampled(scene, truth, shader, samples, &|_| {});
    let picture = filtered(scene, material, shader, Filter::Anisotropic, &|_| {});
    relative_l1(&picture, &truth.picture)
}

#[test]
fn filtered_and_supersampled_pictures_of_constant_maps_agree() {
    let scene = scene(16, Surroundings::Even(5));
    for reflection in [Reflection::Ggx, Reflection::Beckmann, Reflection::BlinnPhong, Reflection::BlinnPhongPrinted] {
        for material in [flat(0.5), tilted(0.5)] {
            let off = error(&scene, &material, &Shader { reflection, ..METAL }, &material, 256);
            assert!(off < 0.03, "{reflection:?}: {off}");
        }
    }
}

/// Compares the reflected light of constant surroundings, summed over lights and over facets.
#[test]
fn sums_over_lights_and_over_facets_agree() {
    let environment = Environment::new(Surroundings::Even(100));
    let to_world = |d: Vector| d;
    for reflection in [Reflection::Ggx, Reflection::Beckmann] {
        let shader = Shader { reflection, ..METAL };
        for (squared_alpha, view) in [
            ([0.09, 0.0, 0.09], [0.0, 0.0, 1.0]),
            ([0.2, 0.05, 0.04], [0.6, 0.3, 0.5]),
            ([0.04, -0.05, 0.2], [0.9, -0.5, 0.3]),
        ] {
            let point = Point { normal: normalised([0.1, 0.2, 1.0]), squared_alpha };
            let view = shader.view(&point, normalised(view));
            let n = 160;
            let (mut of_lights, mut of_facets) = (0.0, 0.0);
            for i in 0..n * n {
                let [a, b] = [i % n, i / n].map(|i| (f64::from(i) + 0.5) / f64::from(n));
                // Directions are spread evenly over the sphere.
                let z = 2.0 * a - 1.0;
                let (sin, cos) = libm::sincos(std::f64::consts::TAU * b);
                let ring = (1.0 - z * z).sqrt();
                let share = 4.0 * std::f64::consts::PI / f64::from(n * n);
                of_lights += view.from_light([ring * cos, ring * sin, z]) * share;
                of_facets += view.sample_environment([a, b], &environment, &to_world)[0] / f64::from(n * n);
            }
            assert!((of_lights - of_facets).abs() < 0.01, "{reflection:?} {of_lights} {of_facets}");
            assert!(of_facets <= 1.0);
        }
    }
}

#[test]
fn printed_and_corrected_angles_agree_for_isotropic_lobes_only() {
    let from_light = |reflection, squared_alpha| {
        let point = Point { normal: [0.0, 0.0, 1.0], squared_alpha };
        let shader = Shader { reflection, ..METAL };
        shader.view(&point, normalised([0.1, 0.3, 1.0])).from_light(normalised([0.3, -0.1, 1.0]))
    };
    let both = |a| [from_light(Reflection::BlinnPhong, a), from_light(Reflection::BlinnPhongPrinted, a)];
    let [corrected, printed] = both([0.1, 0.0, 0.1]);
    assert!((corrected - printed).abs() < 1e-5 * corrected);
    let [corrected, printed] = both([0.2, 0.0, 0.01]);
    assert!((corrected - printed).abs() > 0.1 * corrected);
}

/// Brushed metal reflects stripes. D keeps the stripes across which the lobe is narrow, and lambda_1 blurs all stripes.
#[test]
fn taps_along_the_ellipse_beat_one_level_on_an_anisotropic_lobe() {
    let stripes = Scene { light: None, ..scene(32, Surroundings::Stripes) };
    for rotation in [[1.0, 0.0], [0.0, 1.0], [0.8, 0.6]] {
        let brushed =
            Material { anisotropy: Some(BaseAnisotropy { texture: None, strength: 0.4, rotation }), ..flat(0.15) };
        let of = |filter| error(&stripes, &brushed, &Shader { filter, ..METAL }, &brushed, 256);
        let (ellipse, lambda_1) = (of(EnvironmentFilter::Ellipse), of(EnvironmentFilter::Lambda1));
        assert!(ellipse < 0.75 * lambda_1, "{rotation:?}: {ellipse} {lambda_1}");
    }
}

#[test]
fn pictures_do_not_depend_on_the_number_of_threads() {
    let draw = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let scene = SceneName::Sphere.scene(24, 2.0).expect("a scene");
            let truth = supersampled(&scene, &tilted(0.3), &METAL, 5, &|_| {});
            (truth.picture, truth.half, filtered(&scene, &tilted(0.3), &METAL, Filter::Trilinear, &|_| {}))
        })
    };
    assert_eq!(draw(1), draw(3));
}

#[test]
fn differences_have_known_sizes() {
    let picture = |value: f32| Picture {
        size: [16, 16],
        pixels: (0..256).map(|i| [value * (1.0 + (i % 7) as f32); 3]).collect(),
        coverage: vec![1.0; 256],
    };
    let shown = |picture| Displayed::new(picture, &Tone { exposure: 1.0 });
    let between = |a, b| Difference::between(&shown(a), &shown(b));
    let same = between(picture(0.5), picture(0.5));
    assert_eq!(same.relative_l1, 0.0);
    assert!((same.ssim - 1.0).abs() < 1e-12);
    let double = between(picture(1.0), picture(0.5));
    assert!((double.relative_l1 - 1.0).abs() < 1e-6 && double.ssim < 0.99, "{double:?}");
    // Pixels that the surface does not fill do not count.
    let mut half = picture(0.5);
    half.coverage[..128].fill(0.5);
    let mut wrong = picture(0.5);
    wrong.pixels[..128].fill([9.0; 3]);
    assert_eq!(between(wrong, half), Difference { relative_l1: 0.0, ssim: 1.0 });
    assert_eq!(relative_l1(&picture(1.0), &picture(0.0)), 0.0);
}

/// Checks that waves repeat and have their documented slope.
#[test]
fn waves_have_their_documented_slope() {
    let size = 128;
    let heights = waves(size);
    let at = |x: u32, y: u32| heights[((y % size) * size + x % size) as usize] * size as f32;
    let (mut sum, mut steepest) = (0.0, 0.0_f32);
    for (x, y) in (0..size).flat_map(|y| (0..size).map(move |x| (x, y))) {
        let slope = [at(x + 1, y) - at(x, y), at(x, y + 1) - at(x, y)];
        sum += slope[0] * slope[0] + slope[1] * slope[1];
        steepest = steepest.max(slope[0].abs()).max(slope[1].abs());
    }
    let deviation = (sum / (size * size) as f32).sqrt();
    assert!((0.15..0.25).contains(&deviation), "{deviation}");
    assert!(steepest < 1.0, "{steepest}");
}

#[test]
fn sheets_have_their_panels_and_labels() {
    let picture = Picture { size: [40, 10], pixels: vec![[0.0; 3]; 400], coverage: vec![1.0; 400] };
    let picture = Displayed::new(picture, &Tone { exposure: 1.0 });
    let crop = Some(Crop { left: 20, top: 4, width: 10, height: 2 });
    let labels = || vec!["A1".to_owned()];
    let panel = |crop| Panel { picture: &picture, heading: "H".to_owned(), crop, labels: labels() };
    let sheet = Sheet::from_rows("T", "s", &[vec![panel(None), panel(crop)], vec![panel(crop)]]).expect("a sheet");
    // A header of 53 pixels, then two rows of heading (19), picture (10), region (2 x 4) and label (19), with gaps.
    assert_eq!((sheet.width, sheet.height), (104, 205));
    let at = |x: u32, y: u32| sheet.rgba[((y * sheet.width + x) * 4) as usize];
    // The first picture, the gap behind it, and the second picture.
    assert_eq!((at(8, 80), at(47, 89), at(48, 80), at(56, 80)), (0, 0, 250, 0));
    // Only the second picture has a frame, and below it the region in black.
    assert_eq!((at(8 + 19, 80 + 4), at(56 + 19, 80 + 4), at(56 + 30, 80 + 5)), (0, 255, 255));
    assert_eq!((at(8, 95), at(56, 94), at(56 + 39, 101)), (250, 0, 0));
    // A letter of a label is about 8 pixels wide: the label has ink in two letters, and none behind them.
    let has_ink = |x: std::ops::Range<u32>, y: std::ops::Range<u32>| {
        x.flat_map(|x| y.clone().map(move |y| (x, y))).any(|(x, y)| at(x, y) < 150)
    };
    let label = 94..109;
    assert!(has_ink(8..20, 8..30) && has_ink(8..16, 34..49) && has_ink(8..16, 61..76));
    assert!(has_ink(8..16, label.clone()) && has_ink(16..24, label.clone()) && !has_ink(24..48, label));
    // Texts that are wider than the picture widen their columns, and a title widens the sheet.
    let heading = "supersampled".to_owned();
    let wide = || Panel { picture: &picture, heading: heading.clone(), crop: None, labels: labels() };
    let width = |title: &str| Sheet::from_rows(title, "s", &[vec![panel(None), wide()]]).expect("a sheet").width;
    assert_eq!(width("T"), 2 * (12.0 * 7.8_f32).ceil() as u32 + 3 * 8);
    assert_eq!(width("a title that is wider than both"), (31.0 * 11.385_f32).ceil() as u32 + 2 * 8);
    assert_eq!(Sheet::from_rows("T", "", &[]), None);
    assert_eq!(Sheet::from_rows("T", "", &[Vec::new()]), None);
}

#[test]
fn scenes_show_their_surface_from_outside() {
    for name in [SceneName::Lake, SceneName::Pattern, SceneName::Plane, SceneName::Sphere] {
        let Scene { shape, camera, .. } = name.scene(20, 1.0).expect("a scene");
        let [width, height] = camera.size;
        let hits = (0..width * height).filter_map(|i| {
            let ray = camera.ray(f64::from(i % width) + 0.5, f64::from(i / width) + 0.5);
            Some((ray, shape.hit(camera.eye, ray)?))
        });
        let hits: Vec<_> = hits.collect();
        assert!(hits.len() > (width * height / 2) as usize, "{name:?}");
        assert!(hits.iter().all(|(ray, hit)| dot(*ray, hit.frame[2]) < 0.0), "{name:?}");
    }
}

/// On a flat surface nothing is filtered but the surroundings: the error of a picture is that of their filter.
#[test]
fn sampled_facets_filter_surroundings_nearly_exactly() {
    let scene = SceneName::Sphere.scene(24, 1.0).expect("a scene");
    for reflection in [Reflection::Ggx, Reflection::Beckmann] {
        for roughness in [0.5, 0.8] {
            let flat = flat(roughness);
            let of = |filter| error(&scene, &flat, &Shader { filter, reflection, ..METAL }, &flat, 4096);
            let facets = of(EnvironmentFilter::Facets);
            assert!(facets < 0.045, "{reflection:?} {roughness}: {facets}");
            // A wide lobe is not an ellipse.
            assert!(roughness < 0.6 || of(EnvironmentFilter::Ellipse) > 2.0 * facets, "{reflection:?}");
        }
    }
}
