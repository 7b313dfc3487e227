//! Options that tell how close a camera comes.

use clap::Args;

use crate::bake::View;

/// The camera. Without --nearest all levels count as seen.
#[derive(Debug, Args)]
#[command(next_help_heading = "View options")]
pub struct ViewOptions {
    /// Least distance of the camera from a surface, in units of the scene: the report then tells the finest level that
    /// is sampled on each material.
    #[arg(long, value_parser = positive, value_name = "D", requires = "screen_height")]
    nearest: Option<f64>,
    /// Rows of pixels on the screen.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..), value_name = "PX", requires = "nearest")]
    screen_height: Option<u32>,
    /// Vertical field of view in degrees.
    #[arg(long, value_parser = field_of_view, default_value_t = 45.0, value_name = "DEG", requires = "nearest")]
    fov: f64,
    /// Width of the screen over its height.
    #[arg(long, value_parser = positive, default_value = "1.778", value_name = "RATIO", requires = "nearest")]
    aspect: f64,
    /// Leave levels that are too fine to be sampled out of the textures.
    #[arg(long, requires = "nearest")]
    trim: bool,
}

impl ViewOptions {
    /// The camera, where it is told.
    pub fn view(&self) -> Option<View> {
        Some(View {
            nearest: self.nearest?,
            screen_height: self.screen_height?,
            fov: self.fov,
            aspect: self.aspect,
            trim: self.trim,
        })
    }
}

fn positive(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|number: &f64| number.is_finite() && *number > 0.0)
        .ok_or_else(|| format!("expected a number above 0, found {text:?}"))
}

fn field_of_view(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|degrees| 0.0 < *degrees && *degrees < 180.0)
        .ok_or_else(|| format!("expected degrees between 0 and 180, found {text:?}"))
}
