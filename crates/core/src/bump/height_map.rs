//! Height maps: the first channel of an image; integers are scaled to 0..1.

use crate::image::{Image, MapError, Samples};

/// A height map: the first channel of an image.
pub struct HeightMap {
    image: Image,
}

impl HeightMap {
    /// Reads the first channel of `image` as heights: integers as [0, 1], floats as they are.
    ///
    /// # Errors
    /// Returns [`MapError::NotFinite`] if a sample is NaN or infinite.
    pub fn new(image: Image) -> Result<Self, MapError> {
        image.check_finite()?;
        Ok(Self { image })
    }

    /// Returns the number of columns.
    pub fn width(&self) -> u32 {
        self.image.width
    }

    /// Returns the number of rows.
    pub fn height(&self) -> u32 {
        self.image.height
    }

    /// Returns the distance between neighbouring representable heights.
    pub fn step(&self) -> f32 {
        self.image.step()
    }

    /// Writes row `y` (0 is the top) to `out`, which has `width` heights.
    pub fn row(&self, y: u32, out: &mut [f32]) {
        let channels = self.image.channels as usize;
        let start = y as usize * out.len() * channels;
        let samples = start..start + out.len() * channels;
        match &self.image.samples {
            Samples::U8(all) => first(&all[samples], channels, out, |v| f32::from(v) / 255.0),
            Samples::U16(all) => first(&all[samples], channels, out, |v| f32::from(v) / 65535.0),
            Samples::F32(all) => first(&all[samples], channels, out, |v| v),
        }
    }
}

fn first<T: Copy>(samples: &[T], channels: usize, out: &mut [f32], value: impl Fn(T) -> f32) {
    for (height, texel) in out.iter_mut().zip(samples.chunks_exact(channels)) {
        *height = value(texel[0]);
    }
}
