//! How close a camera comes, and hence the finest mip level that it can sample.

use serde::{Deserialize, Serialize};

use crate::gltf::density::Density;

/// A camera that keeps its distance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct View {
    /// Least distance from a surface, in scene units.
    pub nearest: f64,
    /// Rows of pixels on the screen.
    pub screen_height: u32,
    /// Vertical field of view in degrees.
    pub fov: f64,
    /// Width of the screen over its height.
    pub aspect: f64,
    /// Leave out the levels that this camera cannot sample.
    pub trim: bool,
}

/// The finest level that a camera can sample of a layer's bump map.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Finest {
    /// Level, 0 the finest.
    pub level: usize,
    /// The same if all surfaces were as magnified as they are on average.
    pub typical_level: usize,
    /// Largest length on a surface that a texel of level 0 covers, in scene units.
    pub units_per_texel: f64,
    /// Least length on a surface that a pixel covers, in scene units.
    pub units_per_pixel: f64,
}

impl View {
    /// Least length on a surface that a pixel covers, in scene units.
    ///
    /// In the middle of the screen that is 2 d tan(fov/2) / rows, on a surface that faces the camera; a tilted one is
    /// covered by more. At an angle t from the middle a pixel subtends less, by cos t across and by cos^2 t along the
    /// way to the middle, so that the least is in the corners of the screen, where
    /// tan^2 t = tan^2(fov/2) (1 + aspect^2).
    pub fn units_per_pixel(&self) -> f64 {
        let slope = libm::tan(0.5 * self.fov.to_radians());
        let corner = 1.0 / (1.0 + slope * slope * (1.0 + self.aspect * self.aspect));
        2.0 * self.nearest * slope / f64::from(self.screen_height) * corner
    }

    /// The finest of `levels` levels that is sampled: floor(log2(pixel/texel)), never negative. Trilinear filtering reads
    /// this level and the next coarser one. A bias of the level is not counted, nor that an engine may scale the scene.
    pub fn finest(&self, density: Density, levels: usize) -> Finest {
        let units_per_pixel = self.units_per_pixel();
        let level = |units_per_texel: f64| {
            // By doubling, which is exact, where a logarithm would round.
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
