//! What is drawn, and how.

use std::path::PathBuf;

use crate::lobe::Family;
use crate::render::{EnvironmentFilter, Filter, Reflection, SceneName, Shader};
use crate::settings::Settings;

/// What is drawn, and how.
#[derive(Clone, Debug)]
pub struct PictureOptions {
    /// A .gltf or .glb file, or an image; `None` draws the waves.
    pub input: Option<PathBuf>,
    /// The folder of the pictures.
    pub output: PathBuf,
    /// The scenes; empty for plane and sphere, or for the scenes of the paper if there is no input.
    pub scenes: Vec<SceneName>,
    /// Distances from the eye to the surface, in repeats of the map; empty for distances that suit the scene.
    pub distances: Vec<f64>,
    /// The lobe that shades, and for which the columns are baked.
    pub reflection: Reflection,
    /// How texture filtering averages texels.
    pub filter: Filter,
    /// What filters the surroundings that a lobe reflects.
    pub environment: EnvironmentFilter,
    /// Width of a picture in pixels.
    pub width: u32,
    /// Samples per pixel of the supersampled column.
    pub samples: u32,
    /// Distance between heights 0 and 1, in widths of the map, if the input is an image of heights.
    pub height_scale: Option<f32>,
    /// Roughness of a standalone map or of the waves; `None` for the roughness that suits the scene.
    pub roughness: Option<f32>,
    /// Whether pictures are also written as OpenEXR.
    pub has_exr: bool,
    /// The settings of the bakes. The reflection decides on the family of lobes.
    pub settings: Settings,
}

impl PictureOptions {
    /// Returns the scenes that are drawn.
    pub(super) fn scenes(&self) -> &[SceneName] {
        match (self.scenes.as_slice(), &self.input) {
            ([], Some(_)) => &[SceneName::Plane, SceneName::Sphere],
            ([], None) => &[SceneName::Lake, SceneName::Pattern, SceneName::Highlight],
            (named, _) => named,
        }
    }

    /// Returns the shader of a surface with this reflectance at normal incidence.
    pub(super) fn shader(&self, f0: f64) -> Shader {
        Shader { reflection: self.reflection, filter: self.environment, f0 }
    }

    /// Returns the settings of the bakes. The paper takes its lobes for normal distributions.
    pub(super) fn bake_settings(&self) -> Settings {
        self.settings.with_lobe(match self.reflection {
            Reflection::Ggx => Family::Ggx,
            Reflection::Beckmann | Reflection::BlinnPhong | Reflection::BlinnPhongPrinted => Family::Beckmann,
        })
    }
}
