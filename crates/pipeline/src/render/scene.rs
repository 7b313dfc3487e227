//! Scenes: a surface, a light, surroundings and an eye.

use super::camera::Camera;
use super::environment::{Environment, Radiance, Surroundings};
use super::shape::Shape;
use crate::math::vector::{Vector, dot, normalised};

/// A light that is small compared with its distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// A light with parallel rays, such as the moon.
    Directional {
        /// Unit vector to the light.
        toward: Vector,
        /// Irradiance of a surface that faces it.
        irradiance: f64,
        /// Cosine of the angular radius of its disc in the background.
        cos_radius: f64,
    },
    /// A light at a point.
    Point {
        /// Its position.
        position: Vector,
        /// Irradiance at distance 1.
        intensity: f64,
    },
}

impl Light {
    /// Returns the unit vector from `position` to the light, and the irradiance of a surface at `position` that faces
    /// the light.
    pub fn at(&self, position: Vector) -> (Vector, f64) {
        match *self {
            Self::Directional { toward, irradiance, .. } => (toward, irradiance),
            Self::Point { position: light, intensity } => {
                let away = [0, 1, 2].map(|i| light[i] - position[i]);
                (normalised(away), intensity / dot(away, away).max(1e-12))
            }
        }
    }
}

/// A scene, ready to be drawn.
pub struct Scene {
    /// The surface.
    pub shape: Shape,
    /// The camera.
    pub camera: Camera,
    /// A light in addition to the surroundings.
    pub light: Option<Light>,
    /// The surroundings.
    pub environment: Environment,
    /// Reflectance of the surface at normal incidence.
    pub f0: f64,
    /// Mean brightness of the surface on the picture, 0.2 by day.
    pub key: f64,
}

/// Scenes by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum SceneName {
    /// The moon over a lake: the paper's figures 8 and 9.
    Lake,
    /// A pattern mirrored by a bumpy plane: the paper's figures 10 and 11.
    Pattern,
    /// Phong against Blinn-Phong on a plane: the paper's figure 14.
    Highlight,
    /// A plane in perspective, a point light and a room.
    Plane,
    /// A sphere, a point light and a room.
    Sphere,
}

impl SceneName {
    /// Returns the name used in file names.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lake => "lake",
            Self::Pattern => "pattern",
            Self::Highlight => "highlight",
            Self::Plane => "plane",
            Self::Sphere => "sphere",
        }
    }

    /// Returns a roughness that suits the scene.
    pub fn roughness(self) -> f32 {
        match self {
            Self::Lake => 0.14,
            Self::Pattern => 0.06,
            Self::Highlight | Self::Plane | Self::Sphere => 0.3,
        }
    }

    /// Returns a factor for the heights of [`super::waves`] that suits the scene.
    pub fn wave_height(self) -> f32 {
        match self {
            Self::Pattern => 0.25,
            _ => 1.0,
        }
    }

    /// Returns distances that suit the scene, in repeats of the map.
    pub fn distances(self) -> &'static [f64] {
        match self {
            Self::Lake => &[0.7],
            Self::Pattern => &[2.0],
            Self::Highlight | Self::Plane | Self::Sphere => &[1.0, 4.0],
        }
    }

    /// Returns the scene for pictures `width` pixels wide. `distance` is the distance from the eye to the nearest point
    /// of the surface, in repeats of the map. Returns `None` for the highlight, which shows no material:
    /// [`super::highlight`] draws it.
    pub fn scene(self, width: u32, distance: f64) -> Option<Scene> {
        let size = |aspect: f64| [width.max(1), ((f64::from(width) * aspect) as u32).max(1)];
        let lamp = Light::Point { position: [-1.0, 3.4, 2.2], intensity: 12.0 };
        Some(match self {
            Self::Lake => Scene {
                shape: Shape::Plane { repeats: distance },
                camera: Camera::new([0.0, 0.0, 1.0], [0.0, 1.0, 0.656], 0.525, size(1.1)),
                light: Some(Light::Directional {
                    toward: normalised([0.0, 1.0, 0.09]),
                    irradiance: 1.0,
                    cos_radius: 0.9998,
                }),
                environment: Environment::new(Surroundings::Night),
                f0: 0.02,
                key: 0.09,
            },
            Self::Pattern => Scene {
                shape: Shape::Plane { repeats: distance },
                camera: Camera::new([0.0, 0.0, 1.0], [0.0, 1.0, 0.72], 0.45, size(0.9)),
                light: None,
                environment: Environment::new(Surroundings::Stripes),
                f0: 0.9,
                key: 0.3,
            },
            Self::Highlight => return None,
            Self::Plane => Scene {
                shape: Shape::Plane { repeats: distance },
                camera: Camera::new([0.0, 0.0, 1.0], [0.0, 1.0, 0.55], 0.5, size(0.9)),
                light: Some(lamp),
                environment: Environment::new(Surroundings::Studio),
                f0: 0.9,
                key: 0.2,
            },
            Self::Sphere => Scene {
                // The eye is 2 away from the surface, and a repeat at the equator is tau / repeats long.
                shape: Shape::Sphere { repeats: (std::f64::consts::PI * distance).round().max(1.0) * 2.0 },
                camera: Camera::new([0.0, -3.0, 0.4], [0.0; 3], 0.38, size(1.0)),
                light: Some(Light::Point { position: [-2.0, -4.0, 3.0], intensity: 30.0 }),
                environment: Environment::new(Surroundings::Studio),
                f0: 0.9,
                key: 0.2,
            },
        })
    }
}

impl Scene {
    /// Returns the radiance along the unit vector `ray` if it hits no surface.
    pub fn background(&self, ray: Vector) -> Radiance {
        match self.light {
            Some(Light::Directional { toward, cos_radius, .. }) if dot(ray, toward) > cos_radius => [1e3; 3],
            _ => self.environment.radiance(ray),
        }
    }
}
