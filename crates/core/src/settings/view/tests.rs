use proptest::prelude::*;
use serde_json::json;

use crate::gltf::material::Mapping;
use crate::gltf::meshes::Meshes;
use crate::gltf::scene::placements;
use crate::gltf::texel_size::density;
use crate::math::vector::{Vector, cross, dot};
use crate::settings::view::*;

const VIEW: View = View { nearest: 10.0, screen_height: 1000, fov: 90.0, aspect: 1.0, trim: false };

#[test]
fn a_pixel_in_the_corner_covers_least() {
    // tan 45 = 1: 2 x 10 / 1000 in the middle, and 1 + 1 (1 + 1) = 3 times less in the corner.
    assert!((VIEW.units_per_pixel() - 0.02 / 3.0).abs() < 1e-15);
    // A slit without width: cos^2 of the half field of view, 1/2.
    let slit = View { aspect: 0.0, ..VIEW };
    assert!((slit.units_per_pixel() - 0.01).abs() < 1e-15);
}

/// The pixel's size against rays through its corners, on planes square to the ray, all over the screen.
#[test]
fn no_pixel_covers_less_than_that() {
    for (fov, aspect) in [(45.0, 16.0 / 9.0), (90.0, 1.0), (20.0, 2.37), (110.0, 0.5)] {
        let view = View { fov, aspect, ..VIEW };
        let (slope, rows) = (f64::tan(0.5 * f64::to_radians(fov)), f64::from(view.screen_height));
        let mut least = f64::INFINITY;
        for (i, j) in (0..=20).flat_map(|i| (0..=20).map(move |j| (f64::from(i) / 20.0, f64::from(j) / 20.0))) {
            let ray = [slope * aspect * i, slope * j, 1.0];
            let length = ray.iter().map(|x| x * x).sum::<f64>().sqrt();
            let unit = ray.map(|x| x / length);
            // Derivative of d unit(ray) along the way to the middle, by one pixel.
            let step = 2.0 * slope / rows;
            let out = f64::hypot(ray[0], ray[1]).max(1e-9);
            let moved = [ray[0] * (1.0 + 1e-6 / out), ray[1] * (1.0 + 1e-6 / out), 1.0];
            let moved_length = moved.iter().map(|x| x * x).sum::<f64>().sqrt();
            let change = (0..3).map(|k| (moved[k] / moved_length - unit[k]).powi(2)).sum::<f64>().sqrt();
            if ray[0] + ray[1] > 0.0 {
                least = least.min(view.nearest * change / 1e-6 * step);
            }
        }
        let bound = view.units_per_pixel();
        assert!((least / bound - 1.0).abs() < 1e-4, "{fov} {aspect}: {least} {bound}");
    }
}

#[test]
fn levels_change_at_powers_of_two() {
    let view = View { nearest: 1.0, screen_height: 2, fov: 90.0, aspect: 0.0, ..VIEW };
    let pixel = view.units_per_pixel();
    let finest = |texel, levels| view.finest(Density { longest: texel, typical: 0.5 * texel }, levels);
    let level = |texel| finest(texel, 11).level;
    assert_eq!(level(pixel * 2.0), 0);
    assert_eq!(level(pixel), 0);
    assert_eq!(level(pixel / 2.0), 1);
    assert_eq!(level(pixel / 1.999), 0);
    assert_eq!(level(pixel / 7.999), 2);
    assert_eq!(level(pixel / 8.0), 3);
    assert_eq!(level(pixel / 1e30), 10, "the coarsest there is");
    assert_eq!(finest(pixel / 8.0, 11).typical_level, 4);
    assert_eq!(finest(pixel / 8.0, 1).level, 0);
}

/// Returns the level that a sampler takes for a pixel of `view` (Vulkan 1.3, "Scale Factor Operation" and "LOD
/// Operation" with anisotropy 16), where the ray through `screen` (-1 to 1) meets, at distance `distance`, the plane on
/// which texture coordinates grow by 1 along `u` and `v`, on a map of `size`.
fn sampled(view: &View, screen: [f64; 2], distance: f64, [u, v]: [Vector; 2], size: f64) -> f64 {
    let slope = f64::tan(0.5 * view.fov.to_radians());
    let step = 2.0 / f64::from(view.screen_height);
    let ray = |[x, y]: [f64; 2]| [slope * view.aspect * x, slope * y, -1.0];
    let centre = ray(screen);
    let origin = centre.map(|c| c * distance / dot(centre, centre).sqrt());
    let normal = cross(u, v);
    // Texels at the point where a ray meets the plane, from the duals of u and v.
    let texels = |ray: Vector| {
        let hit = ray.map(|c| c * dot(origin, normal) / dot(ray, normal));
        let from: Vector = std::array::from_fn(|i| hit[i] - origin[i]);
        let area = dot(normal, normal);
        [dot(from, cross(v, normal)) / area * size, dot(from, cross(normal, u)) / area * size]
    };
    // Derivatives by a thousandth of a pixel.
    let slide = |dx: f64, dy: f64| {
        let [s, t] = texels(ray([screen[0] + 1e-3 * dx / view.aspect, screen[1] + 1e-3 * dy]));
        1e3 * f64::hypot(s, t)
    };
    let (across, down) = (slide(step, 0.0), slide(0.0, step));
    let (longer, shorter) = (across.max(down), across.min(down));
    (longer / (longer / shorter).min(16.0)).log2()
}

proptest! {
    /// Any plane, anywhere on the screen, however its texels are stretched.
    #[test]
    fn no_finer_level_is_sampled(
        screen in [-1.0..1.0, -1.0..1.0],
        (fov, aspect, further) in (10.0..120.0, 0.4..3.0, 0.0..3.0),
        u in [-1.0..1.0, -1.0..1.0, -1.0..1.0],
        v in [-1.0..1.0, -1.0..1.0, -1.0..1.0],
        slim in 0.0..8.0_f64,
    ) {
        let view = View { fov, aspect, ..VIEW };
        let v = v.map(|x: f64| f64::from((x * f64::exp2(-slim)) as f32));
        let u = u.map(|x: f64| f64::from(x as f32));
        let normal = cross(u, v);
        prop_assume!(dot(normal, normal) > 1e-9 * dot(u, u) * dot(v, v));
        let floats = [[0.0; 3], u, v].concat().into_iter().chain([0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
        let bytes: Vec<u8> = floats.flat_map(|x| (x as f32).to_le_bytes()).collect();
        let root = json!({
            "scenes": [{ "nodes": [0] }],
            "nodes": [{ "mesh": 0 }],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "material": 0 }] }],
            "accessors": [
                { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" },
                { "bufferView": 0, "byteOffset": 36, "componentType": 5126, "count": 3, "type": "VEC2" },
            ],
            "bufferViews": [{ "buffer": 0, "byteLength": 60 }],
        });
        let size = 1 << 12;
        let placements = placements(&root).unwrap();
        let buffer = |_| Some(bytes.as_slice());
        let density = density(&Meshes::of(&root), &placements, 0, &Mapping::default(), (size, size), &buffer).unwrap();
        let least = (view.units_per_pixel() / density.longest).log2();
        let level = sampled(&view, screen, view.nearest + further, [u, v], f64::from(size));
        // Grazing planes and rays past the horizon have no level.
        prop_assume!(level.is_finite());
        prop_assert!(level >= least - 1e-3, "{level} {least}");
    }
}
