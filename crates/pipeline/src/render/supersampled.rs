//! Drawing with many unfiltered samples for each pixel: the ground truth.

use super::draw::{Advance, Picture, Pixel, add, light_of_lamp, rows};
use super::environment::Radiance;
use super::facets::Facets;
use super::material::Material;
use super::patch::{Meeting, Patch, PatchPoint};
use super::quasirandom::Quasirandom;
use super::samples::{Sample, SampleShader, ShadedSample};
use super::scene::Scene;
use super::shade::{Reflection, Shader};
use super::shape::Hit;
use crate::math::vector::Vector;

/// Pixels whose corners and middle do not see the surface have this part of the samples.
const EMPTY_PIXEL: u32 = 16;

/// Samples that are shaded together.
const BATCH: u32 = 256;

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
                for start in (0..samples).step_by(BATCH as usize) {
                    let points: Vec<[f64; 4]> =
                        (start..samples.min(start + BATCH)).map(|i| sequence.point(i)).collect();
                    self.add_batch(&mut sums, together, &patch, [x, y], &points);
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

    /// Adds the samples of `points` in the pixel, the first of which has an even number.
    fn add_batch(
        &self,
        sums: &mut PixelSums,
        together: &SampleShader,
        patch: &Patch,
        [x, y]: [f64; 2],
        points: &[[f64; 4]],
    ) {
        let places: Vec<[f32; 2]> = points.iter().map(|[px, py, ..]| [*px as f32, *py as f32]).collect();
        let mut found = vec![PatchPoint::default(); points.len()];
        patch.trace(&places, &mut found);
        let (mut samples, mut halves) = (Vec::with_capacity(points.len()), Vec::with_capacity(points.len()));
        for (i, (PatchPoint { position, uv, meeting }, point)) in found.iter().zip(points).enumerate() {
            let half = &mut sums.halves[i % 2];
            match meeting {
                Meeting::Miss => half.add_background(self.scene, self.scene.camera.ray(x + point[0], y + point[1])),
                Meeting::Far => self.add_sample(half, [x, y], *point),
                Meeting::Hit => {
                    let bump = self.facets.at(uv.map(f64::from));
                    halves.push(i % 2);
                    samples.push(Sample {
                        position: *position,
                        normal: bump.normal.map(|c| c as f32),
                        squared_alpha: bump.squared_alpha.map(|a| a as f32),
                        facet: [point[2] as f32, point[3] as f32],
                    });
                }
            }
        }
        let mut shaded = vec![ShadedSample::default(); samples.len()];
        together.shade(&samples, &mut shaded);
        for (half, ShadedSample { from, weight, of_light, area }) in halves.into_iter().zip(shaded) {
            let mut light = [f64::from(of_light); 3];
            if weight > 0.0 {
                add(&mut light, self.scene.environment.radiance(from.map(f64::from)), f64::from(weight));
            }
            sums.halves[half].add_surface(light, f64::from(area));
        }
    }

    /// Adds the sample of one point in the pixel.
    fn add_sample(&self, half: &mut SampleSums, [x, y]: [f64; 2], [px, py, radial, azimuth]: [f64; 4]) {
        let ray = self.scene.camera.ray(x + px, y + py);
        let Some(hit) = self.hit(ray) else {
            return half.add_background(self.scene, ray);
        };
        let point = self.facets.at(hit.uv);
        let view = self.shader.view(&point, hit.to_tangent(ray).map(|c| -c));
        let to_world = |d| hit.to_world(d);
        let mut light = view.sample_environment([radial, azimuth], &self.scene.environment, &to_world);
        add(&mut light, light_of_lamp(self.scene, &view, &hit), 1.0);
        half.add_surface(light, view.visible_area());
    }
}

/// The samples of a pixel: the even ones and the odd ones.
#[derive(Default)]
struct PixelSums {
    halves: [SampleSums; 2],
}

impl PixelSums {
    fn all(&self) -> SampleSums {
        let [even, odd] = &self.halves;
        let sum = |a: Radiance, b: Radiance| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
        SampleSums {
            surface: sum(even.surface, odd.surface),
            area: even.area + odd.area,
            covered: even.covered + odd.covered,
            behind: sum(even.behind, odd.behind),
            count: even.count + odd.count,
        }
    }

    fn light(&self) -> Radiance {
        self.all().light()
    }

    fn coverage(&self) -> f32 {
        let SampleSums { covered, count, .. } = self.all();
        (covered / count) as f32
    }
}

/// Sums over samples.
#[derive(Default)]
struct SampleSums {
    /// Light of the surface times area.
    surface: Radiance,
    area: f64,
    /// Number of samples that show the surface.
    covered: f64,
    /// Light of samples that show the background.
    behind: Radiance,
    /// Number of samples.
    count: f64,
}

impl SampleSums {
    fn add_surface(&mut self, light: Radiance, area: f64) {
        add(&mut self.surface, light, area);
        self.area += area;
        self.covered += 1.0;
        self.count += 1.0;
    }

    fn add_background(&mut self, scene: &Scene, ray: Vector) {
        add(&mut self.behind, scene.background(ray), 1.0);
        self.count += 1.0;
    }

    /// Returns the mean light.
    fn light(&self) -> Radiance {
        let share = if self.area > 0.0 { self.covered / self.area } else { 0.0 };
        [0, 1, 2].map(|c| (share * self.surface[c] + self.behind[c]) / self.count.max(1.0))
    }
}
