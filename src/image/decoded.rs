//! The decoded image: what a file holds, at the depth at which it holds it.

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
    /// The values. 16384 x 16384 x 3 at 8 bits is 805 MB: they are not widened.
    pub samples: Samples,
}

/// The values of an [`Image`], as deep as the file stores them.
#[derive(Debug, Clone, PartialEq)]
pub enum Samples {
    /// 8-bit unsigned normalised: 0 is 0.0, 255 is 1.0.
    U8(Vec<u8>),
    /// 16-bit unsigned normalised: 0 is 0.0, 65535 is 1.0.
    U16(Vec<u16>),
    /// The file's own floating-point values, halves widened. Any range; NaN and infinities are passed on.
    F32(Vec<f32>),
}

impl Samples {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Samples::U8(values) => values.len(),
            Samples::U16(values) => values.len(),
            Samples::F32(values) => values.len(),
        }
    }

    /// Whether there is no value.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The value at `index` of the interleaved array: in [0, 1] for the normalised depths, as
    /// stored for floats. `None` past the end.
    pub fn get(&self, index: usize) -> Option<f32> {
        match self {
            Samples::U8(values) => values.get(index).map(|&v| f32::from(v) / 255.0),
            Samples::U16(values) => values.get(index).map(|&v| f32::from(v) / 65535.0),
            Samples::F32(values) => values.get(index).copied(),
        }
    }

    /// Bits per value: 8, 16 or 32.
    pub fn bits(&self) -> u32 {
        match self {
            Samples::U8(_) => 8,
            Samples::U16(_) => 16,
            Samples::F32(_) => 32,
        }
    }
}

impl Image {
    /// Channel `c` of the texel in column `x` of row `y` (row 0 is the top one), see
    /// [`Samples::get`]. `None` outside the image.
    pub fn sample(&self, x: u32, y: u32, c: u32) -> Option<f32> {
        if x >= self.width || y >= self.height || c >= self.channels {
            return None;
        }
        let texel = u64::from(y) * u64::from(self.width) + u64::from(x);
        let index = texel * u64::from(self.channels) + u64::from(c);
        self.samples.get(usize::try_from(index).ok()?)
    }

    /// Distance between neighbouring values at the depth of the file; for floats at most that at the largest magnitude,
    /// of half floats where all values are such.
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

    /// The values as little-endian bytes in storage order: the same on every machine, so they can
    /// be hashed. 8-bit images are borrowed.
    pub fn bytes(&self) -> Cow<'_, [u8]> {
        match &self.samples {
            Samples::U8(values) => Cow::Borrowed(values),
            Samples::U16(values) => values.iter().flat_map(|v| v.to_le_bytes()).collect(),
            Samples::F32(values) => values.iter().flat_map(|v| v.to_le_bytes()).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_those_of_the_depth() {
        let step = |samples| Image { width: 1, height: 2, channels: 1, samples }.step();
        assert_eq!(step(Samples::U8(vec![0, 7])), 1.0 / 255.0);
        assert_eq!(step(Samples::U16(vec![0, 7])), 1.0 / 65535.0);
        // 1024 and 1025 are neighbours among half floats, and 1024 + 2^-13 follows 1024 among single ones.
        assert_eq!(step(Samples::F32(vec![1024.0, -0.5])), 1.0);
        assert_eq!(step(Samples::F32(vec![-1024.0, 0.1])), f32::from_bits(1024f32.to_bits() + 1) - 1024.0);
        assert_eq!(step(Samples::F32(vec![0.0, 0.0])), 0.0);
    }
}
