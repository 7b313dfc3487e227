//! A picture as a display shows it.

use rayon::prelude::*;

use super::draw::Picture;
use super::tone::Tone;

/// A picture, and what a display shows of it.
pub struct Displayed {
    /// Linear radiance.
    pub picture: Picture,
    /// Red, green and blue of each pixel for a display with gamma 2.2, in [0, 1].
    pub values: Vec<[f64; 3]>,
}

impl Displayed {
    /// Displays `picture` by `tone`.
    pub fn new(picture: Picture, tone: &Tone) -> Self {
        let values = picture.pixels.par_iter().map(|pixel| tone.displayed(*pixel)).collect();
        Self { picture, values }
    }

    /// Returns the bytes of pixel `i`.
    pub fn bytes(&self, i: usize) -> [u8; 3] {
        self.values[i].map(|value| (value * 255.0).round() as u8)
    }
}
