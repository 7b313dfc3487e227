//! How close a camera comes, and hence the finest mip level that it can sample.

use serde::{Deserialize, Serialize};

use super::error::SettingsError;
use super::limit;
use crate::gltf::texel_size::Density;

/// A camera that never comes nearer to a surface than `nearest`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct View {
    /// Least distance from a surface, in scene units.
    pub nearest: f64,
    /// Rows of pixels on the screen.
    pub screen_height: u32,
    /// Vertical field of view in degrees.
    pub fov: f64,
    /// Width of the screen over its height.
    pub aspect: f64,
    /// Whether levels that this camera cannot sample are left out.
    pub trim: bool,
}

/// The finest level that a camera can sample of a layer's bump map.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
#[non_exhaustive]
pub struct Finest {
    /// Level, 0 the finest.
    pub level: usize,
    /// The finest level if all surfaces had the average magnification.
    pub typical_level: usize,
    /// Largest length on a surface that a texel of level 0 covers, in scene units.
    pub units_per_texel: f64,
    /// Least length on a surface that a pixel covers, in scene units.
    pub units_per_pixel: f64,
}

impl View {
    /// Vertical field of view in degrees if none is given.
    pub const DEFAULT_FOV: f64 = 45.0;
    /// Width of the screen over its height if none is given.
    pub const DEFAULT_ASPECT: f64 = 1.778;

    /// Returns a camera with a field of view of 45 degrees and a screen of 16:9, for which no level is left out.
    pub fn new(nearest: f64, screen_height: u32) -> Self {
        Self { nearest, screen_height, fov: Self::DEFAULT_FOV, aspect: Self::DEFAULT_ASPECT, trim: false }
    }

    /// Checks every value.
    ///
    /// # Errors
    /// [`SettingsError::Range`] for the first value that is out of its range.
    pub fn validate(&self) -> Result<(), SettingsError> {
        limit::NEAREST.check(self.nearest)?;
        limit::SCREEN_HEIGHT.check(f64::from(self.screen_height))?;
        limit::FOV.check(self.fov)?;
        limit::ASPECT.check(self.aspect)?;
        Ok(())
    }

    /// Returns the least length on a surface that a pixel covers, in scene units.
    ///
    /// In the middle of the screen the length is 2 d tan(fov/2) / rows on a surface that faces the camera; on a tilted
    /// surface it is larger. At an angle t from the middle a pixel subtends less, by cos t across and by cos^2 t along
    /// the way to the middle. The least length is therefore in the corners of the screen, where tan^2 t = tan^2(fov/2)
    /// (1 + aspect^2).
    pub fn units_per_pixel(&self) -> f64 {
        let slope = libm::tan(0.5 * self.fov.to_radians());
        let corner = 1.0 / (1.0 + slope * slope * (1.0 + self.aspect * self.aspect));
        2.0 * self.nearest * slope / f64::from(self.screen_height) * corner
    }

    /// Returns the finest of `levels` levels that is sampled: floor(log2(pixel/texel)), never negative. Trilinear
    /// filtering reads this level and the next coarser one. A level bias of the sampler and a scale of the scene are
    /// not counted.
    pub fn finest(&self, density: Density, levels: usize) -> Finest {
        let units_per_pixel = self.units_per_pixel();
        let level = |units_per_texel: f64| {
            // Doubling is exact; a logarithm would round.
            let (mut covered, mut level) = (2.0 * units_per_texel, 0);
            while level + 1 < levels && covered <= units_per_pixel {
                covered *= 2.0;
                level += 1;
            }
            level
        };
        Finest {
            level: level(density.longest),
            typical_level: level(density.typical),
            units_per_texel: density.longest,
            units_per_pixel,
        }
    }
}

#[cfg(test)]
mod tests;
