//! Pictures that Bevy draws of a baked plane, on any Vulkan. Mesa's software renderer is enough.

mod asset;
mod lobe;
mod renderer;

use std::path::{Path, PathBuf};

use asset::{Asset, Baked, ROUGHNESS};
use bevy::math::{Mat2, Vec2};
use lobe::Lobe;
use renderer::{Picture, Renderer};

/// Makes the plane in a temporary folder, or returns `None` where the tests cannot run.
fn setup() -> Option<(tempfile::TempDir, Asset)> {
    let missing = match tool() {
        None => "`cargo build` in the folder of Roughcast (or $ROUGHCAST)",
        Some(_) if !has_vulkan() => "Vulkan (Debian: mesa-vulkan-drivers)",
        Some(tool) => {
            let folder = tempfile::tempdir().unwrap();
            let asset = Asset::new(folder.path(), tool);
            return Some((folder, asset));
        }
    };
    assert!(std::env::var("CI").as_deref() != Ok("true"), "pictures need {missing}");
    eprintln!("skipped: pictures need {missing}");
    None
}

/// Returns $ROUGHCAST, else the newest tool that Cargo built.
fn tool() -> Option<PathBuf> {
    if let Some(tool) = std::env::var_os("ROUGHCAST") {
        return Some(tool.into());
    }
    let target = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target");
    let built = ["release", "debug"].map(|profile| target.join(profile).join("roughcast"));
    built.into_iter().filter(|tool| tool.exists()).max_by_key(|tool| tool.metadata().and_then(|m| m.modified()).ok())
}

fn has_vulkan() -> bool {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::VULKAN;
    let adapters = wgpu::Instance::new(descriptor).enumerate_adapters(wgpu::Backends::VULKAN);
    !bevy::tasks::block_on(adapters).is_empty()
}

/// Returns the mean difference over the mean radiance.
fn relative_l1(found: &Picture, expected: &Picture) -> f32 {
    let difference: f32 = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).sum();
    difference / expected.iter().sum::<f32>()
}

fn assert_close(found: &Picture, expected: &Picture, tolerance: f32, what: &str) {
    let error = relative_l1(found, expected);
    assert!(error <= tolerance, "{what}: expected a picture off by at most {tolerance}, found {error}");
}

/// Returns what each pixel shows without filtering: the base lobe about the normals of all texels.
fn reference(slopes: &[Vec2]) -> Picture {
    let lobes: Vec<Lobe> = slopes.iter().map(|slope| Lobe { slope: *slope, ..base_lobe() }).collect();
    lobe::mean(&lobes)
}

/// Returns the slope of the only texel of the last level of normals. The mean slope of the map is 0. The fit ends with
/// steps of 0.02 alphas, which are 0.01 here, and encoding moves the slope by one step more, 0.005.
fn shown_slope(asset: &Asset, baked: &Baked) -> Vec2 {
    let normal = 2.0 * asset.last_texel(baked, "normal") - 1.0;
    let slope = -normal.truncate() / normal.z;
    assert!(slope.abs().max_element() < 0.015, "{slope}");
    slope
}

/// Returns the base lobe.
fn base_lobe() -> Lobe {
    Lobe::isotropic(ROUGHNESS * ROUGHNESS)
}

#[test]
fn a_pyramid_shades_with_the_lobe_of_the_extension() {
    let Some((folder, asset)) = setup() else { return };
    let mut renderer = Renderer::new(folder.path(), true);
    let baked = asset.bake("factor", "--profile pyramid --model anisotropic");
    let slope = baked.slope(asset.last_texel(&baked, "offset"));
    // The mean slope of the map is 0. The fit ends with steps of 0.02 alphas, which are 0.01 here, and encoding moves
    // the slope by one step more, 0.005.
    assert!(slope.abs().max_element() < 0.015, "{slope}");
    let d = baked.roughness(asset.last_texel(&baked, "factor"));
    let k = Mat2::from_cols_array(&[d.x * d.x + d.y * d.y, d.y * d.z, d.y * d.z, d.z * d.z]);
    let bumpy = |bumps: Mat2| Lobe { a: base_lobe().a + bumps, bumps, slope };
    let anisotropic = bumpy(2.0 * baked.correction_factor() * k);
    let factor = renderer.draw(&baked.path);
    assert_close(&factor, &anisotropic.picture(), 0.005, "D");
    // One lobe cannot come closer. Without K the error is 0.9.
    assert_close(&factor, &reference(&asset.slopes), 0.3, "D and the reference");

    let baked = asset.bake("deviation", "--profile pyramid --model isotropic");
    let lambda_1 = baked.roughness(asset.last_texel(&baked, "lambda1")).x;
    let isotropic = bumpy(2.0 * baked.correction_factor() * lambda_1 * lambda_1 * Mat2::IDENTITY);
    let deviation = renderer.draw(&baked.path);
    assert_close(&deviation, &isotropic.picture(), 0.005, "lambda_1");
    assert!(relative_l1(&deviation, &factor) > 0.1);

    // Other frames give the same picture. On the plane z = 0, m = x has e1 = -y and e2 = x.
    for (name, options) in [("natural", ""), ("mainDirection", "--main-direction 1,0,0")] {
        let frame = if name == "natural" { name } else { "main-direction" };
        let baked = asset.bake(name, &format!("--profile pyramid --model anisotropic --frame {frame} {options}"));
        assert_eq!(baked.frame(), name);
        assert_close(&renderer.draw(&baked.path), &factor, 0.005, name);
    }
}

#[test]
fn axes_of_anisotropic_lobes_follow_the_normal_where_no_bumps_are_lost() {
    let Some((folder, asset)) = setup() else { return };
    let (slope, strength) = (Vec2::new(0.4, 0.2), 0.8_f32);
    asset.make_tilted(slope, strength);
    let baked = asset.bake("tilted", "--profile pyramid --model none");
    let across = ROUGHNESS * ROUGHNESS;
    let along = across + (1.0 - across) * strength * strength;
    let a = Mat2::from_diagonal(Vec2::new(along * along, across * across));
    let lobe = Lobe { a, slope, ..base_lobe() };
    assert_close(&Renderer::new(folder.path(), true).draw(&baked.path), &lobe.picture(), 0.02, "tilted lobe");
}

#[test]
fn a_roughened_core_material_is_not_roughened_again() {
    let Some((folder, asset)) = setup() else { return };
    let mut renderer = Renderer::new(folder.path(), true);
    let [pyramid, both] = ["pyramid", "both"].map(|profile| {
        let baked = asset.bake(profile, &format!("--profile {profile} --model anisotropic"));
        renderer.draw(&baked.path)
    });
    assert_close(&both, &pyramid, 0.001, "both profiles");
}

#[test]
fn diffuse_light_is_the_mean_over_the_normals_of_the_bumps() {
    let Some((folder, asset)) = setup() else { return };
    let mut renderer = Renderer::new(folder.path(), true);
    asset.make_matt();
    let baked = asset.bake("matt", "--profile pyramid --model isotropic");
    let lambda_1 = baked.roughness(asset.last_texel(&baked, "lambda1")).x;
    let variance = baked.correction_factor() * lambda_1 * lambda_1;
    // Bevy's diffuse light depends on the roughness, too: A' = A + 2 c lambda_1^2.
    let flat = renderer.draw(&asset.matt((ROUGHNESS.powi(4) + 2.0 * variance).powf(0.25)));
    let expected: Picture = flat.iter().map(|light| light / (1.0 + 2.0 * variance).sqrt()).collect();
    assert!(relative_l1(&flat, &expected) > 0.03, "the bumps are too low");
    assert_close(&renderer.draw(&baked.path), &expected, 0.01, "diffuse light");
}

#[test]
fn a_portable_asset_needs_no_plugin() {
    let Some((folder, asset)) = setup() else { return };
    let mut renderer = Renderer::new(folder.path(), false);
    let reference = reference(&asset.slopes);
    let baked = asset.bake("none", "--model none");
    let plain = renderer.draw(&baked.path);
    assert_close(&plain, &Lobe { slope: shown_slope(&asset, &baked), ..base_lobe() }.picture(), 0.02, "plain mips");
    let baked = asset.bake("portable", "--model isotropic");
    let portable = renderer.draw(&baked.path);
    let roughness = asset.last_texel(&baked, "roughness").y;
    let lobe = Lobe { slope: shown_slope(&asset, &baked), ..Lobe::isotropic(roughness * roughness) };
    assert_close(&portable, &lobe.picture(), 0.02, "portable");
    let [error, plain_error] = [&portable, &plain].map(|picture| relative_l1(picture, &reference));
    assert!(error < 0.8 * plain_error, "expected less than the error of plain mips, {plain_error}, found {error}");
}

/// When this test fails, Bevy has corrected its shader: the override in pyramid.wgsl can go, and `roughcast bake
/// --engine bevy` may bake anisotropic lobes.
#[test]
fn bevy_squares_the_alphas_of_anisotropic_lobes_once_more() {
    let Some((folder, asset)) = setup() else { return };
    let (roughness, strength) = (0.7_f32, 0.5_f32);
    let picture = Renderer::new(folder.path(), false).draw(&asset.anisotropic(roughness, strength));
    let expected = |across: f32| {
        let along = across + (1.0 - across) * strength * strength;
        let a = Mat2::from_diagonal(Vec2::new(along * along, across * across));
        Lobe { a, ..base_lobe() }.picture()
    };
    // Pictures are normalised, since multiple scattering depends on the roughness of the material.
    let shape = |picture: Picture| -> Picture {
        let sum: f32 = picture.iter().sum();
        picture.iter().map(|value| value / sum).collect()
    };
    let picture = shape(picture);
    let error = |power| relative_l1(&shape(expected(roughness.powi(power))), &picture);
    let (khronos, squared) = (error(2), error(4));
    assert!(khronos > 0.3, "off by {khronos} from KHR_materials_anisotropy");
    assert!(squared < 0.01, "off by {squared} from its squared alphas");
}
