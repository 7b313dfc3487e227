//! Drawing with many unfiltered samples for each pixel: the ground truth.

use super::draw::{Advance, Picture, Pixel, add, light_of_lamp, rows};
use super::environment::Radiance;
use super::facets::Facets;
use super::material::Material;
use super::patch::{Meeting, Patch, PatchPoint};
use super::quasirandom::Quasirandom;
use super::sample_sums::{PixelSums, SampleSums};
use super::samples::{Sample, SampleShader, ShadedSample};
use super::scene::Scene;
use super::shade::{Reflection, Shader};
use super::shape::Hit;
use crate::math::vector::Vector;

/// Pixels whose corners and middle do not see the surface have this part of the samples.
const EMPTY_PIXEL: u32 = 16;

/// Samples that are shaded together.
const BATCH: usize = 256;

/// Memory for samples that are shaded together.
#[derive(Default)]
struct Batch {
    points: Vec<[f32; 4]>,
    found: Vec<PatchPoint>,
    samples: Vec<Sample>,
    shaded: Vec<ShadedSample>,
    /// The light from the surroundings.
    light: Vec<[f32; 3]>,
}

/// The ground truth, and a picture of half of its samples for an estimate of its noise.
pub struct Supersampled {
    /// The picture of all samples.
    pub picture: Picture,
    /// The picture of every other sample.
    pub half: Picture,
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
    let together = (shader.reflection == Reflection::Ggx).then(|| SampleShader::new(scene, shader.f0));
    let truth = Truth { scene, shader, together, facets, samples };
    let pixel: Pixel<'_, PixelSums> = &|x, y| truth.pixel(x, y);
    let pixels = rows(scene, advance, pixel);
    let coverage: Vec<f32> = pixels.iter().map(PixelSums::coverage).collect();
    let picture = |light: &dyn Fn(&PixelSums) -> Radiance| Picture {
        size: scene.camera.size,
        pixels: pixels.iter().map(|sums| light(sums).map(|value| value as f32)).collect(),
        coverage: coverage.clone(),
    };
    Supersampled { picture: picture(&PixelSums::light), half: picture(&|sums| sums.halves[1].light()) }
}

/// What is drawn, and how.
struct Truth<'a> {
    scene: &'a Scene,
    shader: &'a Shader,
    /// Shades many samples together, if the reflection is GGX.
    together: Option<SampleShader>,
    facets: Facets<'a>,
    /// Samples of a pixel.
    samples: u32,
}

impl Truth<'_> {
    /// Draws the pixel whose upper left corner is at (`x`, `y`).
    fn pixel(&self, x: f64, y: f64) -> PixelSums {
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        let hit = |right: f64, down: f64| self.hit(self.scene.camera.ray(x + right, y + down));
        let middle = hit(0.5, 0.5);
        let is_empty = middle.is_none() && corners.iter().all(|[right, down]| hit(*right, *down).is_none());
        let samples = if is_empty { (self.samples / EMPTY_PIXEL).max(2) } else { self.samples };
        let sequence = Quasirandom::new(x as u32, y as u32);
        let mut sums = PixelSums::default();
        match (&self.together, middle) {
            (Some(together), Some(middle)) => {
                let patch = Patch::new(self.scene.shape, &self.scene.camera, [x, y], &middle);
                let mut batch = Batch::default();
                for (half, sums) in (0..).zip(&mut sums.halves) {
                    let count = samples.saturating_sub(half).div_ceil(2);
                    for start in (0..count).step_by(BATCH) {
                        let points = (start..count.min(start + BATCH as u32)).map(|i| sequence.point(2 * i + half));
                        self.add_batch(sums, together, &patch, [x, y], points, &mut batch);
                    }
                }
            }
            _ => {
                (0..samples).for_each(|i| self.add_sample(&mut sums.halves[i as usize % 2], [x, y], sequence.point(i)))
            }
        }
        sums
    }

    fn hit(&self, ray: Vector) -> Option<Hit> {
        self.scene.shape.hit(self.scene.camera.eye, ray)
    }

    /// Adds the samples of `points` in the pixel.
    fn add_batch(
        &self,
        sums: &mut SampleSums,
        together: &SampleShader,
        patch: &Patch,
        [x, y]: [f64; 2],
        points: impl Iterator<Item = [f32; 4]>,
        batch: &mut Batch,
    ) {
        let Batch { points: places, found, samples, shaded, light } = batch;
        places.clear();
        places.extend(points);
        found.resize(places.len(), PatchPoint::default());
        patch.trace(places.iter().map(|[px, py, ..]| [*px, *py]), found);
        samples.clear();
        for (PatchPoint { position, uv, meeting }, point) in found.iter().zip(&*places) {
            match meeting {
                Meeting::Hit => samples.push(Sample {
                    position: *position,
                    bump: self.facets.within(*uv),
                    at: [point[2], point[3]],
                }),
                Meeting::Miss => sums.add_background(
                    self.scene,
                    self.scene.camera.ray(x + f64::from(point[0]), y + f64::from(point[1])),
                ),
                Meeting::Far => self.add_sample(sums, [x, y], *point),
            }
        }
        shaded.resize(samples.len(), ShadedSample::default());
        together.shade(samples, shaded);
        light.resize(samples.len(), [0.0; 3]);
        self.scene.environment.surroundings().radiance_row(shaded.iter().map(|sample| sample.from), light);
        sums.add_surface(
            shaded.iter().zip(&*light).map(|(ShadedSample { weight, of_light, area, .. }, light)| {
                (light.map(|c| weight * c + of_light), *area)
            }),
        );
    }

    /// Adds the sample of one point in the pixel.
    fn add_sample(&self, half: &mut SampleSums, [x, y]: [f64; 2], point: [f32; 4]) {
        let [px, py, radial, azimuth] = point.map(f64::from);
        let ray = self.scene.camera.ray(x + px, y + py);
        let Some(hit) = self.hit(ray) else {
            return half.add_background(self.scene, ray);
        };
        let point = self.facets.at(hit.uv);
        let view = self.shader.view(&point, hit.to_tangent(ray).map(|c| -c));
        let to_world = |d| hit.to_world(d);
        let mut light = view.sample_environment([radial, azimuth], &self.scene.environment, &to_world);
        add(&mut light, light_of_lamp(self.scene, &view, &hit), 1.0);
        half.add_surface([(light.map(|c| c as f32), view.visible_area() as f32)].into_iter());
    }
}
