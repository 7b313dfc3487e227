//! Normal maps: tangent-space normals in two or three channels of an image.

mod unused;

use rayon::prelude::*;

use crate::image::{Image, MapError, Samples, each};
use crate::simd::dispatch;
use unused::fill;

/// Which channels of an image hold the normal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum NormalLayout {
    /// x and y if the image has two channels, or if its third channel is 0 in all texels (as BC5 and RG textures
    /// decode); otherwise x, y and z.
    #[default]
    #[cfg_attr(feature = "cli", value(help = "x and y where a third channel is missing or empty, else x, y, z"))]
    Auto,
    /// x, y, z in the first three channels.
    #[cfg_attr(feature = "cli", value(help = "x, y, z"))]
    Xyz,
    /// x and y in the first two channels; z = sqrt(1 - x^2 - y^2).
    #[cfg_attr(feature = "cli", value(help = "x and y"))]
    Xy,
}

/// A normal map.
///
/// Integers encode [-1, 1] as 2v - 1, as glTF engines decode them. Floats are components if any x or y is negative, and
/// otherwise encode components as 2v - 1. Further channels (alpha) are ignored.
///
/// Black texels beside others hold no normal, since every component would be -1: they are the parts of an atlas that no
/// triangle shows. They get normals of the texels around them, so that they add no roughness at the edges of other
/// parts. So do normals below the surface in such a map, which are mostly blends with black.
pub struct NormalMap {
    image: Image,
    has_z: bool,
    signed: bool,
    green_down: bool,
    unused: u64,
}

/// Bounds on the magnitude of the largest component of a normal. Squares of both bounds, and 256 times these squares,
/// are finite, normal floats.
const LONGEST: f64 = 1e9;
const SHORTEST: f64 = 1e-9;

impl NormalMap {
    /// Reads `image` as normals. If `green_down` is set, y points down the image (DirectX convention) and is negated.
    ///
    /// # Errors
    /// [`MapError::Channels`] with fewer than two channels, or fewer than three under [`NormalLayout::Xyz`];
    /// [`MapError::NotFinite`] with NaN or infinity.
    pub fn new(image: Image, layout: NormalLayout, green_down: bool) -> Result<Self, MapError> {
        let needed = if layout == NormalLayout::Xyz { 3 } else { 2 };
        if image.channels < needed {
            return Err(MapError::Channels {
                expected: if needed == 3 {
                    "a normal map with x, y and z"
                } else {
                    "a normal map with at least x and y"
                },
                found: image.channels,
            });
        }
        image.check_finite()?;
        let has_z = match layout {
            NormalLayout::Xyz => true,
            NormalLayout::Xy => false,
            NormalLayout::Auto => image.channels > 2 && !image.is_zero(2),
        };
        let signed = image.has_negative(2);
        let mut map = Self { image, has_z, signed, green_down, unused: 0 };
        map.shorten();
        map.fill_unused();
        Ok(map)
    }

    /// Scales vectors whose squares overflow or underflow to a length of about 1. Only the direction of a normal
    /// counts.
    fn shorten(&mut self) {
        let (channels, signed, has_z) = (self.image.channels as usize, self.signed, self.has_z);
        let Samples::F32(samples) = &mut self.image.samples else { return };
        samples.par_chunks_exact_mut(channels).for_each(|texel| {
            // If z is rebuilt, short x and y are valid.
            let (vector, least) = if has_z { (&mut texel[..3], SHORTEST) } else { (&mut texel[..2], 0.0) };
            let component = |sample: f32| if signed { f64::from(sample) } else { 2.0 * f64::from(sample) - 1.0 };
            let longest = vector.iter().map(|sample| component(*sample).abs()).fold(0.0, f64::max);
            if longest > 0.0 && !(least..=LONGEST).contains(&longest) {
                for sample in vector {
                    let scaled = component(*sample) / longest;
                    *sample = (if signed { scaled } else { 0.5 * scaled + 0.5 }) as f32;
                }
            }
        });
    }

    /// Gives normals to texels that hold none.
    fn fill_unused(&mut self) {
        let (width, channels, has_z) = (self.image.width as usize, self.image.channels as usize, self.has_z);
        let stored = |component: f32, most: f32| (most * (0.5 * component + 0.5)).round();
        self.unused = match &mut self.image.samples {
            Samples::U8(all) => fill(all, width, channels, has_z, of_byte, |c| stored(c, 255.0) as u8),
            Samples::U16(all) => fill(all, width, channels, has_z, of_word, |c| stored(c, 65535.0) as u16),
            Samples::F32(_) if self.signed => 0,
            Samples::F32(all) => fill(all, width, channels, has_z, of_biased, |c| 0.5 * c + 0.5),
        };
    }

    /// Returns the number of columns.
    pub fn width(&self) -> u32 {
        self.image.width
    }

    /// Returns the number of rows.
    pub fn height(&self) -> u32 {
        self.image.height
    }

    /// Returns the number of texels that have got normals of the texels around them.
    pub fn unused(&self) -> u64 {
        self.unused
    }

    /// Returns whether z is stored; otherwise z is rebuilt from x and y.
    pub fn has_z(&self) -> bool {
        self.has_z
    }

    /// Returns the distance between neighbouring representable values of x or y near 0.
    pub fn step(&self) -> f32 {
        if self.signed { self.image.step() } else { 2.0 * self.image.step() }
    }

    /// Writes row `y` (0 is the top) to `out`, which has `width` normals of any length.
    pub fn row(&self, y: u32, out: &mut [[f32; 3]]) {
        let channels = self.image.channels as usize;
        let start = y as usize * out.len() * channels;
        let samples = start..start + out.len() * channels;
        match &self.image.samples {
            Samples::U8(all) => self.decode(&all[samples], out, of_byte),
            Samples::U16(all) => self.decode(&all[samples], out, of_word),
            Samples::F32(all) if self.signed => self.decode(&all[samples], out, |v| v),
            Samples::F32(all) => self.decode(&all[samples], out, of_biased),
        }
    }

    fn decode<T: Copy>(&self, samples: &[T], out: &mut [[f32; 3]], component: impl Fn(T) -> f32) {
        match self.image.channels {
            2 => each(samples, out, |&[x, y]| [component(x), component(y), 0.0]),
            3 => dispatch!(fearless_simd::Level::new(), _simd => {
                out.as_flattened_mut().iter_mut().zip(samples).for_each(|(out, &sample)| *out = component(sample));
            }),
            _ => each(samples, out, |&[x, y, z, _]| [component(x), component(y), component(z)]),
        }
        if self.green_down {
            out.iter_mut().for_each(|normal| normal[1] = -normal[1]);
        }
        if !self.has_z {
            out.iter_mut().for_each(|[x, y, z]| *z = (1.0 - *x * *x - *y * *y).max(0.0).sqrt());
        }
    }
}

#[inline(always)]
fn of_byte(v: u8) -> f32 {
    f32::from(v) * (2.0 / 255.0) - 1.0
}

#[inline(always)]
fn of_word(v: u16) -> f32 {
    f32::from(v) * (2.0 / 65535.0) - 1.0
}

#[inline(always)]
fn of_biased(v: f32) -> f32 {
    2.0 * v - 1.0
}

impl Image {
    /// Returns whether channel `c` is 0 in every texel.
    fn is_zero(&self, c: usize) -> bool {
        let n = self.channels as usize;
        match &self.samples {
            Samples::U8(v) => v.par_chunks_exact(n).all(|t| t[c] == 0),
            Samples::U16(v) => v.par_chunks_exact(n).all(|t| t[c] == 0),
            Samples::F32(v) => v.par_chunks_exact(n).all(|t| t[c] == 0.0),
        }
    }

    /// Returns whether one of the first `count` channels is negative in any texel.
    fn has_negative(&self, count: usize) -> bool {
        match &self.samples {
            Samples::F32(v) => v.par_chunks_exact(self.channels as usize).any(|t| t[..count].iter().any(|s| *s < 0.0)),
            _ => false,
        }
    }

    /// Checks that all samples are finite, because NaN and infinity have no mean and no lobe.
    ///
    /// # Errors
    /// Returns [`MapError::NotFinite`] if a sample is NaN or infinite.
    pub fn check_finite(&self) -> Result<(), MapError> {
        let Samples::F32(samples) = &self.samples else {
            return Ok(());
        };
        let texels = samples.par_chunks_exact(self.channels as usize);
        let bad = |texel: &[f32]| texel.iter().any(|s| !s.is_finite());
        let Some(first) = texels.clone().position_first(bad) else {
            return Ok(());
        };
        Err(MapError::NotFinite {
            count: texels.filter(|t| bad(t)).count() as u64,
            x: (first % self.width as usize) as u32,
            y: (first / self.width as usize) as u32,
        })
    }
}

#[cfg(test)]
mod tests;
