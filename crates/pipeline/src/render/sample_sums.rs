//! Sums over the samples of a pixel.

use super::draw::add;
use super::environment::Radiance;
use super::scene::Scene;
use crate::math::vector::Vector;

/// The samples of a pixel: the even ones and the odd ones.
#[derive(Default)]
pub struct PixelSums {
    /// Their sums.
    pub halves: [SampleSums; 2],
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

    /// Returns the mean light.
    pub fn light(&self) -> Radiance {
        self.all().light()
    }

    /// Returns the share of the samples that show the surface.
    pub fn coverage(&self) -> f32 {
        let SampleSums { covered, count, .. } = self.all();
        (covered / count) as f32
    }
}

/// Sums over samples.
#[derive(Default)]
pub struct SampleSums {
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
    /// Adds samples of the surface: light, and its weight `area`.
    pub fn add_surface(&mut self, samples: impl ExactSizeIterator<Item = ([f32; 3], f32)>) {
        let count = samples.len() as f64;
        self.covered += count;
        self.count += count;
        for (light, area) in samples {
            let area = f64::from(area);
            add(&mut self.surface, light.map(f64::from), area);
            self.area += area;
        }
    }

    /// Adds a sample whose `ray` misses the surface.
    pub fn add_background(&mut self, scene: &Scene, ray: Vector) {
        add(&mut self.behind, scene.background(ray), 1.0);
        self.count += 1.0;
    }

    /// Returns the mean light.
    pub fn light(&self) -> Radiance {
        let share = if self.area > 0.0 { self.covered / self.area } else { 0.0 };
        [0, 1, 2].map(|c| (share * self.surface[c] + self.behind[c]) / self.count.max(1.0))
    }
}
