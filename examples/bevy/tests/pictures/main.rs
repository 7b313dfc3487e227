//! Pictures that Bevy draws of a baked plane, on any Vulkan: Mesa's in software will do.

mod asset;
mod lobe;
mod renderer;

use std::path::{Path, PathBuf};

use asset::{Asset, ROUGHNESS};
use bevy::math::{Mat2, Vec2};
use lobe::Lobe;
use renderer::{Picture, Renderer};

/// The plane in a folder that goes with it; none where tests cannot run.
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

/// $ROUGHCAST, or the newest that Cargo built.
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

/// Mean difference over mean radiance.
fn relative_l1(found: &Picture, expected: &Picture) -> f32 {
    let difference: f32 = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).sum();
    difference / expected.iter().sum::<f32>()
}

fn assert_close(found: &Picture, expected: &Picture, tolerance: f32, what: &str) {
    let error = relative_l1(found, expected);
    assert!(error <= tolerance, "{what}: expected a picture off by at most {tolerance}, found {error}");
}

/// K of all slopes of the map, and their mean.
fn moments(slopes: &[Vec2]) -> (Mat2, Vec2) {
    let count = slopes.len() as f32;
    let mean = slopes.iter().sum::<Vec2>() / count;
    let outer = |s: Vec2| Mat2::from_cols(s * s.x, s * s.y);
    (slopes.iter().map(|s| outer(*s - mean)).fold(Mat2::ZERO, |a, b| a + b) * (1.0 / count), mean)
}

/// What each pixel sees in truth: the material's own lobe about the normals of all texels.
fn truth(slopes: &[Vec2]) -> Picture {
    let lobes: Vec<Lobe> = slopes.iter().map(|slope| Lobe { slope: *slope, ..own() }).collect();
    lobe::mean(&lobes)
}

/// The material's own lobe.
fn own() -> Lobe {
    Lobe::circle(ROUGHNESS * ROUGHNESS)
}

#[test]
fn a_pyramid_is_the_lobe_that_the_extension_tells() {
    let Some((folder, asset)) = setup() else { return };
    let mut renderer = Renderer::new(folder.path(), true);
    let (k, slope) = moments(&asset.slopes);
    let baked = asset.bake("factor", "--profile pyramid --model anisotropic");
    let ellipse = Lobe { a: own().a + 2.0 * baked.correction_factor() * k, slope };
    let factor = renderer.draw(&baked.path);
    assert_close(&factor, &ellipse.picture(), 0.005, "D");
    // As one lobe can: without K it is off by 0.9.
    assert_close(&factor, &truth(&asset.slopes), 0.3, "D and the truth");

    let baked = asset.bake("deviation", "--profile pyramid --model isotropic");
    let (middle, radius) = Lobe { a: k, slope }.middle_and_radius();
    let circle = own().a + 2.0 * baked.correction_factor() * (middle + radius) * Mat2::IDENTITY;
    let deviation = renderer.draw(&baked.path);
    assert_close(&deviation, &Lobe { a: circle, slope }.picture(), 0.005, "lambda_1");
    assert!(relative_l1(&deviation, &factor) > 0.1);

    // The same bumps in other frames are the same picture. On the plane z = 0, m = x has e1 = -y and e2 = x.
    for (name, options) in [("natural", ""), ("mainDirection", "--main-direction 1,0,0")] {
        let frame = if name == "natural" { name } else { "main-direction" };
        let baked = asset.bake(name, &format!("--profile pyramid --model anisotropic --frame {frame} {options}"));
        assert_eq!(baked.frame(), name);
        assert_close(&renderer.draw(&baked.path), &factor, 0.005, name);
    }
}

#[test]
fn bumps_count_once_where_the_core_material_has_them_too() {
    let Some((folder, asset)) = setup() else { return };
    let mut renderer = Renderer::new(folder.path(), true);
    let [pyramid, both] = ["pyramid", "both"].map(|profile| {
        let baked = asset.bake(profile, &format!("--profile {profile} --model anisotropic"));
        renderer.draw(&baked.path)
    });
    assert_close(&both, &pyramid, 0.001, "both profiles");
}

#[test]
fn a_portable_asset_needs_no_plugin() {
    let Some((folder, asset)) = setup() else { return };
    let mut renderer = Renderer::new(folder.path(), false);
    let truth = truth(&asset.slopes);
    let plain = renderer.draw(&asset.bake("none", "--model none").path);
    // Normals of this level are off by a step of the encoder.
    assert_close(&plain, &own().picture(), 0.05, "plain mips");
    let baked = asset.bake("portable", "--model isotropic");
    let portable = renderer.draw(&baked.path);
    let roughness = asset.last_roughness(&baked);
    assert_close(&portable, &Lobe::circle(roughness * roughness).picture(), 0.03, "portable");
    let [off, plainly_off] = [&portable, &plain].map(|picture| relative_l1(picture, &truth));
    assert!(off < 0.8 * plainly_off, "expected less than the error of plain mips, {plainly_off}, found {off}");
}

/// Once it does not, the override in pyramid.wgsl can go, and `roughcast bake --engine bevy` may have ellipses.
#[test]
fn bevy_squares_the_alphas_of_ellipses_once_more() {
    let Some((folder, asset)) = setup() else { return };
    let (roughness, strength) = (0.7_f32, 0.5_f32);
    let picture = Renderer::new(folder.path(), false).draw(&asset.ellipse(roughness, strength));
    let ellipse = |across: f32| {
        let along = across + (1.0 - across) * strength * strength;
        Lobe { a: Mat2::from_diagonal(Vec2::new(along * along, across * across)), slope: Vec2::ZERO }.picture()
    };
    // Not how bright it is: multiple scattering goes by the roughness that is told.
    let shape = |picture: Picture| -> Picture {
        let sum: f32 = picture.iter().sum();
        picture.iter().map(|value| value / sum).collect()
    };
    let picture = shape(picture);
    let off = |power| relative_l1(&shape(ellipse(roughness.powi(power))), &picture);
    let (khronos, squared) = (off(2), off(4));
    assert!(khronos > 0.3, "off by {khronos} from KHR_materials_anisotropy");
    assert!(squared < 0.01, "off by {squared} from its squared alphas");
}
