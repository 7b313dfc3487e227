//! The ranges of all numbers among the settings.

use super::error::SettingsError;
use crate::gltf::material::MAX_HEIGHT_SCALE;

/// The range of a number.
#[derive(Clone, Copy, Debug)]
pub struct Limit {
    /// The setting.
    pub name: &'static str,
    /// The range, in words.
    pub expected: &'static str,
    accepts: fn(f64) -> bool,
}

impl Limit {
    /// Returns whether `value` is finite and in the range.
    pub fn accepts(&self, value: f64) -> bool {
        value.is_finite() && (self.accepts)(value)
    }

    /// Returns `value` if it is in the range.
    ///
    /// # Errors
    /// [`SettingsError::Range`].
    pub fn check(&self, value: f64) -> Result<f64, SettingsError> {
        let Self { name, expected, .. } = *self;
        if self.accepts(value) {
            Ok(value)
        } else {
            Err(SettingsError::Range { name, expected, found: value.to_string() })
        }
    }
}

const POSITIVE: &str = "a number above 0";

/// The range of [`Settings::max_error`](crate::settings::Settings::max_error).
pub const MAX_ERROR: Limit =
    Limit { name: "max-error", expected: "a number from 0 to 1", accepts: |x| (0.0..=1.0).contains(&x) };
/// The range of [`Settings::rdo`](crate::settings::Settings::rdo), in dB.
pub const RDO: Limit = Limit { name: "rdo", expected: "a number above 0, up to 6", accepts: |x| 0.0 < x && x <= 6.0 };
/// The range of [`Settings::max_size`](crate::settings::Settings::max_size), in texels: a block has four.
pub const MAX_SIZE: Limit = Limit { name: "max-size", expected: "a number of texels from 4", accepts: |x| x >= 4.0 };
/// The range of [`Settings::height_scale`](crate::settings::Settings::height_scale).
pub const HEIGHT_SCALE: Limit = Limit {
    name: "height-scale",
    expected: "a number from -1000000 to 1000000",
    accepts: |x| x.abs() <= MAX_HEIGHT_SCALE as f64,
};
/// The range of [`View::nearest`](crate::settings::View::nearest), in scene units.
pub const NEAREST: Limit = Limit { name: "nearest", expected: POSITIVE, accepts: |x| x > 0.0 };
/// The range of [`View::screen_height`](crate::settings::View::screen_height), in pixels.
pub const SCREEN_HEIGHT: Limit = Limit { name: "screen-height", expected: POSITIVE, accepts: |x| x > 0.0 };
/// The range of [`View::fov`](crate::settings::View::fov), in degrees.
pub const FOV: Limit = Limit { name: "fov", expected: "degrees between 0 and 180", accepts: |x| 0.0 < x && x < 180.0 };
/// The range of [`View::aspect`](crate::settings::View::aspect).
pub const ASPECT: Limit = Limit { name: "aspect", expected: POSITIVE, accepts: |x| x > 0.0 };

#[cfg(test)]
mod tests;
