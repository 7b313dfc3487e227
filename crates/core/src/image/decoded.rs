//! The decoded image: the values of a file at the depth at which the file stores them.

use std::borrow::Cow;

use half::f16;
use rayon::prelude::*;

/// A decoded image: rows top to bottom, texels left to right, channels interleaved.
///
/// `samples` holds exactly `width * height * channels` values.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Width in texels, at least 1.
    pub width: u32,
    /// Height in texels, at least 1.
    pub height: u32,
    /// Channels per texel, 1 to 4: R, RG (or grey and alpha), RGB, RGBA.
    pub channels: u32,
    /// The values. They are not widened, because 16384 x 16384 x 3 values of 8 bits are already 805 MB.
    pub samples: Samples,
}

/// The values of an [`Image`] at the depth of the file.
#[derive(Debug, Clone, PartialEq)]
pub enum Samples {
    /// 8-bit unsigned normalised: 0 is 0.0, 255 is 1.0.
    U8(Vec<u8>),
    /// 16-bit unsigned normalised: 0 is 0.0, 65535 is 1.0.
    U16(Vec<u16>),
    /// Floating-point values as stored in the file; half floats are widened. Values may have any range and may be NaN
    /// or infinite.
    F32(Vec<f32>),
}

impl Samples {
    /// Returns the number of values.
    pub fn len(&self) -> usize {
        match self {
            Samples::U8(values) => values.len(),
            Samples::U16(values) => values.len(),
            Samples::F32(values) => values.len(),
        }
    }

    /// Returns whether there are no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the value at `index` of the interleaved array, or `None` past the end. Integers are scaled to [0, 1],
    /// and floats are returned as stored.
    pub fn get(&self, index: usize) -> Option<f32> {
        match self {
            Samples::U8(values) => values.get(index).map(|&v| f32::from(v) / 255.0),
            Samples::U16(values) => values.get(index).map(|&v| f32::from(v) / 65535.0),
            Samples::F32(values) => values.get(index).copied(),
        }
    }

    /// Returns the bits of a value: 8, 16 or 32.
    pub fn bits(&self) -> u32 {
        match self {
            Samples::U8(_) => 8,
            Samples::U16(_) => 16,
            Samples::F32(_) => 32,
        }
    }
}

impl Image {
    /// Returns channel `c` of the texel in column `x` of row `y` (row 0 is the top row) as [`Samples::get`] does, or
    /// `None` outside the image.
    pub fn sample(&self, x: u32, y: u32, c: u32) -> Option<f32> {
        if x >= self.width || y >= self.height || c >= self.channels {
            return None;
        }
        let texel = u64::from(y) * u64::from(self.width) + u64::from(x);
        let index = texel * u64::from(self.channels) + u64::from(c);
        self.samples.get(usize::try_from(index).ok()?)
    }

    /// Returns the distance between neighbouring values at the depth of the file. For floats, this is an upper bound:
    /// the distance at the largest magnitude, between half floats if all values are half floats.
    pub fn step(&self) -> f32 {
        match &self.samples {
            Samples::U8(_) => 1.0 / 255.0,
            Samples::U16(_) => 1.0 / 65535.0,
            Samples::F32(values) => {
                let largest = values.par_iter().map(|v| v.abs()).reduce(|| 0.0, f32::max);
                let is_half = values.par_iter().all(|v| f16::from_f32(*v).to_f32() == *v);
                largest * if is_half { f16::EPSILON.to_f32() } else { f32::EPSILON }
            }
        }
    }

    /// Returns the values as little-endian bytes in storage order, which are equal on every machine and can be hashed.
    /// 8-bit images are borrowed.
    pub fn bytes(&self) -> Cow<'_, [u8]> {
        match &self.samples {
            Samples::U8(values) => Cow::Borrowed(values),
            Samples::U16(values) => values.iter().flat_map(|v| v.to_le_bytes()).collect(),
            Samples::F32(values) => values.iter().flat_map(|v| v.to_le_bytes()).collect(),
        }
    }
}

#[cfg(test)]
mod tests;
