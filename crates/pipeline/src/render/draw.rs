//! Drawing with one filtered sample per pixel, as hardware shades.

use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use super::environment::Radiance;
use super::material::Material;
use super::sampler::{Filter, Texture};
use super::scene::Scene;
use super::shade::{Shader, View};
use super::shape::Hit;
use crate::math::vector::Vector;

/// A picture of linear radiance.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Red, green and blue of each pixel, rows top to bottom.
    pub pixels: Vec<[f32; 3]>,
    /// Share of each pixel that the surface covers.
    pub coverage: Vec<f32>,
}

/// Receives the finished share of the work, from any thread.
pub type Advance<'a> = &'a (dyn Fn(f32) + Sync);

/// Coverage samples along each side of a pixel.
const EDGE_SAMPLES: u32 = 4;

/// Draws `material` as an engine does: one shaded sample per pixel with filtered textures, and edges smoothed by
/// coverage.
pub fn filtered(scene: &Scene, material: &Material, shader: &Shader, filter: Filter, advance: Advance<'_>) -> Picture {
    by_pixel(scene, advance, &|x, y| {
        let Covered { share, middle: [x, y], behind: mut sum } = covered(scene, [x, y]);
        let ray = scene.camera.ray(x, y);
        if let (true, Some(hit)) = (share > 0.0, scene.shape.hit(scene.camera.eye, ray)) {
            let footprint = hit.footprint(&scene.camera, x, y);
            let point = material.point(&|texture: &Texture| texture.sample(hit.uv, &footprint, filter));
            let view = shader.view(&point, hit.to_tangent(ray).map(|c| -c));
            let to_world = |d: Vector| hit.to_world(d);
            add(&mut sum, view.from_environment(&scene.environment, &to_world), share);
            add(&mut sum, light_of_lamp(scene, &view, &hit), share);
        }
        (sum, share)
    })
}

/// What of a pixel the surface covers.
struct Covered {
    share: f64,
    /// The middle of that part, where the surface is shaded.
    middle: [f64; 2],
    /// Light from behind the surface in the rest of the pixel.
    behind: Radiance,
}

fn covered(scene: &Scene, [x, y]: [f64; 2]) -> Covered {
    let at = |k: u32| (f64::from(k) + 0.5) / f64::from(EDGE_SAMPLES);
    let last = EDGE_SAMPLES - 1;
    let is_hit = |right: u32, down: u32| {
        scene.shape.hit(scene.camera.eye, scene.camera.ray(x + at(right), y + at(down))).is_some()
    };
    // The outlines of all shapes are convex.
    if is_hit(0, 0) && is_hit(last, 0) && is_hit(0, last) && is_hit(last, last) {
        return Covered { share: 1.0, middle: [x + 0.5, y + 0.5], behind: [0.0; 3] };
    }
    let (mut hits, mut sum, mut behind) = (0.0, [0.0; 2], [0.0; 3]);
    for (right, down) in (0..EDGE_SAMPLES).flat_map(|down| (0..EDGE_SAMPLES).map(move |right| (right, down))) {
        let [x, y] = [x + at(right), y + at(down)];
        if is_hit(right, down) {
            hits += 1.0;
            sum = [sum[0] + x, sum[1] + y];
        } else {
            add(&mut behind, scene.background(scene.camera.ray(x, y)), 1.0);
        }
    }
    let count = f64::from(EDGE_SAMPLES * EDGE_SAMPLES);
    Covered { share: hits / count, middle: sum.map(|c| c / f64::max(hits, 1.0)), behind: behind.map(|c| c / count) }
}

/// Returns the radiance that a point reflects from the light of the scene.
pub(super) fn light_of_lamp(scene: &Scene, view: &View<'_>, hit: &Hit) -> Radiance {
    let Some(light) = &scene.light else { return [0.0; 3] };
    let (toward, irradiance) = light.at(hit.position);
    [irradiance * view.from_light(hit.to_tangent(toward)); 3]
}

/// Adds `weight` times `value` to `sum`.
pub(super) fn add(sum: &mut Radiance, value: Radiance, weight: f64) {
    for (sum, value) in sum.iter_mut().zip(value) {
        *sum += weight * value;
    }
}

/// Computes one pixel from its column and row.
pub(super) type Pixel<'a, T> = &'a (dyn Fn(f64, f64) -> T + Sync);

/// Runs `pixel` for each pixel. The result does not depend on the number of threads.
pub(super) fn rows<T: Send>(scene: &Scene, advance: Advance<'_>, pixel: Pixel<'_, T>) -> Vec<T> {
    let [width, height] = scene.camera.size;
    let done = AtomicU32::new(0);
    let row = |y: u32| {
        let row: Vec<T> = (0..width).map(|x| pixel(f64::from(x), f64::from(y))).collect();
        advance((done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / height as f32);
        row
    };
    (0..height).into_par_iter().flat_map_iter(row).collect()
}

fn by_pixel(scene: &Scene, advance: Advance<'_>, pixel: Pixel<'_, (Radiance, f64)>) -> Picture {
    let (pixels, coverage) =
        rows(scene, advance, pixel).into_iter().map(|(value, c)| (value.map(|v| v as f32), c as f32)).unzip();
    Picture { size: scene.camera.size, pixels, coverage }
}
