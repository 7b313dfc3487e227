//! Drawing with one filtered sample per pixel, as hardware shades, or with many unfiltered samples.

use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use super::environment::Radiance;
use super::facets::Facets;
use super::material::{Material, Point};
use super::sampler::{Filter, Texture};
use super::scene::Scene;
use super::shade::Shader;
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
/// Pixels whose corners and middle do not see the surface have this part of the samples.
const EMPTY_PIXEL: u32 = 16;

/// Draws `material` as an engine does: one shaded sample per pixel with filtered textures, and edges smoothed by
/// coverage.
pub fn filtered(scene: &Scene, material: &Material, shader: &Shader, filter: Filter, advance: Advance<'_>) -> Picture {
    by_pixel(scene, advance, &|x, y| {
        let samples = (0..EDGE_SAMPLES * EDGE_SAMPLES).map(|i| {
            let at = |k: u32| (f64::from(k) + 0.5) / f64::from(EDGE_SAMPLES);
            (x + at(i % EDGE_SAMPLES), y + at(i / EDGE_SAMPLES))
        });
        let (mut covered, mut covered_sum, mut behind) = (0.0, [0.0; 2], [0.0; 3]);
        for (x, y) in samples {
            let ray = scene.camera.ray(x, y);
            if scene.shape.hit(scene.camera.eye, ray).is_some() {
                covered += 1.0;
                covered_sum = [covered_sum[0] + x, covered_sum[1] + y];
            } else {
                add(&mut behind, scene.background(ray), 1.0);
            }
        }
        let count = f64::from(EDGE_SAMPLES * EDGE_SAMPLES);
        let mut sum = behind.map(|c| c / count);
        // The shaded point is the mean of the covered samples.
        let [x, y] = covered_sum.map(|c| c / f64::max(covered, 1.0));
        let ray = scene.camera.ray(x, y);
        if let (true, Some(hit)) = (covered > 0.0, scene.shape.hit(scene.camera.eye, ray)) {
            let footprint = hit.footprint(&scene.camera, x, y);
            let point = material.point(&|texture: &Texture| texture.sample(hit.uv, &footprint, filter));
            let Shaded { light, .. } = shaded(scene, &point, shader, &hit, ray, None);
            add(&mut sum, light, covered / count);
        }
        (sum, covered / count)
    })
}

/// Draws `material` with `samples` unfiltered samples per pixel. Each sample shades the nearest texel of level 0 and
/// sends one ray into the surroundings. Also returns the picture of the odd samples alone, for an estimate of the
/// noise. Pixels that show the surroundings alone have fewer samples, since nothing is measured there.
///
/// [`View::visible_area`](super::View::visible_area) is the weight of a sample.
pub fn supersampled(
    scene: &Scene,
    material: &Material,
    shader: &Shader,
    samples: u32,
    advance: Advance<'_>,
) -> Supersampled {
    let [width, height] = scene.camera.size;
    let facets = Facets::new(material, u64::from(width) * u64::from(height) * u64::from(samples));
    let sees = |x: f64, y: f64| scene.shape.hit(scene.camera.eye, scene.camera.ray(x, y)).is_some();
    let both = by_pixel_pair(scene, advance, &|x, y| {
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        let middle = scene.shape.hit(scene.camera.eye, scene.camera.ray(x + 0.5, y + 0.5));
        let is_empty = middle.is_none() && !corners.iter().any(|[right, down]| sees(x + right, y + down));
        let samples = if is_empty { (samples / EMPTY_PIXEL).max(2) } else { samples };
        let sequence = Quasirandom::new(x as u32, y as u32);
        // Light and area of the surface in the even and the odd samples, and the background of each.
        let (mut surface, mut areas) = ([[0.0; 3]; 2], [0.0; 2]);
        let (mut behind, mut covered) = ([[0.0; 3]; 2], [0.0; 2]);
        for i in 0..samples {
            let [px, py, radial, azimuth] = sequence.point(i);
            let half = (i % 2) as usize;
            let ray = scene.camera.ray(x + px, y + py);
            match scene.shape.hit_beside(scene.camera.eye, ray, middle.as_ref()) {
                None => add(&mut behind[half], scene.background(ray), 1.0),
                Some(hit) => {
                    let point = facets.at(hit.uv);
                    let Shaded { light, area } = shaded(scene, &point, shader, &hit, ray, Some([radial, azimuth]));
                    add(&mut surface[half], light, area);
                    areas[half] += area;
                    covered[half] += 1.0;
                }
            }
        }
        let mean = |surface: Radiance, area: f64, covered: f64, behind: Radiance, count: u32| {
            let share = if area > 0.0 { covered / area } else { 0.0 };
            [0, 1, 2].map(|c| (share * surface[c] + behind[c]) / f64::from(count.max(1)))
        };
        let both = |values: [Radiance; 2]| [0, 1, 2].map(|c| values[0][c] + values[1][c]);
        let covered_by_both = covered[0] + covered[1];
        let all = mean(both(surface), areas[0] + areas[1], covered_by_both, both(behind), samples);
        let odd = mean(surface[1], areas[1], covered[1], behind[1], samples / 2);
        (all, odd, covered_by_both / f64::from(samples))
    });
    let pixels = |half: usize| both.iter().map(|(values, _)| values[half]).collect();
    let coverage: Vec<f32> = both.iter().map(|(_, coverage)| *coverage).collect();
    let size = scene.camera.size;
    Supersampled {
        picture: Picture { size, pixels: pixels(0), coverage: coverage.clone() },
        half: Picture { size, pixels: pixels(1), coverage },
    }
}

/// The ground truth, and a picture of half of its samples for an estimate of its noise.
pub struct Supersampled {
    /// The picture of all samples.
    pub picture: Picture,
    /// The picture of every other sample.
    pub half: Picture,
}

/// The light that a point sends to the eye, and the projected area of its facet.
struct Shaded {
    light: Radiance,
    area: f64,
}

fn shaded(scene: &Scene, point: &Point, shader: &Shader, hit: &Hit, ray: Vector, facet: Option<[f64; 2]>) -> Shaded {
    let view = shader.view(point, hit.to_tangent(ray).map(|c| -c));
    let to_world = |d: Vector| hit.to_world(d);
    let mut sum = match facet {
        None => view.from_environment(&scene.environment, &to_world),
        Some(facet) => view.sample_environment(facet, &scene.environment, &to_world),
    };
    if let Some(light) = &scene.light {
        let (toward, irradiance) = light.at(hit.position);
        let share = view.from_light(hit.to_tangent(toward));
        add(&mut sum, [irradiance; 3], share);
    }
    Shaded { light: sum, area: view.visible_area() }
}

fn add(sum: &mut Radiance, value: Radiance, weight: f64) {
    for (sum, value) in sum.iter_mut().zip(value) {
        *sum += weight * value;
    }
}

type Pixel<'a, T> = &'a (dyn Fn(f64, f64) -> T + Sync);

/// Runs `pixel` for each pixel. The result does not depend on the number of threads.
fn rows<T: Send>(scene: &Scene, advance: Advance<'_>, pixel: Pixel<'_, T>) -> Vec<T> {
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

/// The values of a pixel from all and from the odd samples, and its coverage.
type Pair = ([[f32; 3]; 2], f32);

fn by_pixel_pair(scene: &Scene, advance: Advance<'_>, pixel: Pixel<'_, (Radiance, Radiance, f64)>) -> Vec<Pair> {
    let narrow = |value: Radiance| value.map(|v| v as f32);
    rows(scene, advance, pixel).into_iter().map(|(a, b, c)| ([narrow(a), narrow(b)], c as f32)).collect()
}

/// A quasirandom sequence in the four-dimensional unit cube (M. Roberts, "The unreasonable effectiveness of quasirandom
/// sequences", 2018), shifted for each pixel, so that the pattern of the sequence is not visible (R. Cranley, T.
/// Patterson, 1976). Numbers are in units of 2^-64, so that they wrap around by themselves.
struct Quasirandom {
    start: [u64; 4],
}

impl Quasirandom {
    /// The powers -1 to -4 of 1.16730..., the root of x^5 = x + 1.
    const STEPS: [u64; 4] =
        [0xdb4f_0b91_75ae_2165, 0xbbe0_5633_03a4_615f, 0xa0f2_ec75_a1fe_1575, 0x89e1_8285_7d9e_d688];

    /// Returns the sequence of a pixel. The finaliser of MurmurHash3 makes the bits of its shift.
    fn new(x: u32, y: u32) -> Self {
        let start = [1, 2, 3, 4].map(|salt: u32| {
            let mut bits = x.wrapping_mul(0x9e37_79b9) ^ y.wrapping_mul(0x85eb_ca6b).rotate_left(13) ^ (salt << 27);
            for multiplier in [0x85eb_ca6b, 0xc2b2_ae35] {
                bits = (bits ^ (bits >> 15)).wrapping_mul(multiplier);
            }
            u64::from(bits ^ (bits >> 16)) << 32
        });
        Self { start }
    }

    /// Returns point `i`.
    fn point(&self, i: u32) -> [f64; 4] {
        let at = |axis: usize| self.start[axis].wrapping_add(Self::STEPS[axis].wrapping_mul(u64::from(i) + 1));
        [0, 1, 2, 3].map(|axis| (at(axis) >> 11) as f64 / (1u64 << 53) as f64)
    }
}
