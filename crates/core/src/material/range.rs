//! What the texels of D and lambda_1 stand for.

use serde::{Deserialize, Serialize};

/// The values that texels of 0 and 1 stand for, channel by channel: value = min + texel (max - min).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Range {
    /// Value of a texel of 0.
    pub min: Vec<f32>,
    /// Value of a texel of 1.
    pub max: Vec<f32>,
}

impl Range {
    /// Returns the range from 0 to `bounds`, and for each channel that is `signed`, as far below 0.
    pub(super) fn new(bounds: &[f32], signed: &[bool]) -> Self {
        // A range of no width has no inverse. Any width serves a flat map.
        let max: Vec<f32> = bounds.iter().map(|b| if *b > 0.0 { *b } else { 1.0 }).collect();
        // Slightly further below 0 than above 0, so that 0 is stored exactly, as the byte 128.
        let min = max.iter().zip(signed).map(|(b, signed)| if *signed { -b * (128.0 / 127.0) } else { 0.0 }).collect();
        Self { min, max }
    }

    /// Returns the range under which texels are the values themselves.
    pub(super) fn identity(channels: usize) -> Self {
        Self { min: vec![0.0; channels], max: vec![1.0; channels] }
    }

    /// Returns the range of the same texels after the values of each channel are multiplied by a factor.
    pub fn scaled(mut self, factors: [f32; 3]) -> Self {
        for values in [&mut self.min, &mut self.max] {
            values.iter_mut().zip(factors).for_each(|(value, factor)| *value *= factor);
        }
        self
    }

    /// Returns the values of the first channels of a texel.
    pub fn values<const N: usize>(&self, texel: [f32; 4]) -> [f32; N] {
        let value = |c: usize| match (self.min.get(c), self.max.get(c)) {
            (Some(min), Some(max)) => min + texel[c] * (max - min),
            _ => 0.0,
        };
        std::array::from_fn(value)
    }

    /// Returns the texel of a value.
    pub(super) fn normalise(&self, value: f32, channel: usize) -> f32 {
        (value - self.min[channel]) / (self.max[channel] - self.min[channel])
    }
}
