//! Options of the camera.

use clap::Args;

use crate::project::Values;
use crate::settings::limit;

/// The camera. Without --nearest, all levels count as sampled.
#[derive(Debug, Args)]
#[command(next_help_heading = "View options")]
pub struct ViewOptions {
    /// Least distance of the camera from a surface, in units of the scene. The report then names the finest level that
    /// is sampled on each material.
    #[arg(long, value_parser = positive, allow_negative_numbers = true, value_name = "D")]
    nearest: Option<f64>,
    /// Rows of pixels on the screen.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..), value_name = "PX")]
    screen_height: Option<u32>,
    /// Vertical field of view in degrees. [default: 45]
    #[arg(long, value_parser = field_of_view, allow_negative_numbers = true, value_name = "DEG")]
    fov: Option<f64>,
    /// Width of the screen over its height. [default: 1.778]
    #[arg(long, value_parser = positive, allow_negative_numbers = true, value_name = "RATIO")]
    aspect: Option<f64>,
    /// Leave levels that are too fine to be sampled out of the textures.
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true", value_name = "BOOL")]
    trim: Option<bool>,
}

impl ViewOptions {
    /// Returns `values` with the explicit values of these options.
    pub fn values(&self, values: Values) -> Values {
        Values {
            nearest: self.nearest,
            screen_height: self.screen_height,
            fov: self.fov,
            aspect: self.aspect,
            trim: self.trim,
            ..values
        }
    }
}

fn positive(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|number| limit::NEAREST.accepts(*number))
        .ok_or_else(|| format!("expected {}, found {text:?}", limit::NEAREST.expected))
}

fn field_of_view(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|degrees| limit::FOV.accepts(*degrees))
        .ok_or_else(|| format!("expected {}, found {text:?}", limit::FOV.expected))
}
