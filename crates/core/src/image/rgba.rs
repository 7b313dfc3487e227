//! Images as rows of RGBA values, as a shader reads them.

use std::array::from_fn;

use rayon::prelude::*;

use crate::image::MapError;
use crate::image::decoded::{Image, Samples};
use crate::mip::TexelRows;

impl Image {
    /// Expands grey with alpha to four channels, as engines read such files. Other images do not change. Do not call
    /// this method for a KTX2 or EXR file, whose two channels are red and green.
    pub fn with_grey_as_colour(self) -> Self {
        fn expand<T: Copy>(samples: &[T]) -> Vec<T> {
            samples.chunks_exact(2).flat_map(|t| [t[0], t[0], t[0], t[1]]).collect()
        }
        if self.channels != 2 {
            return self;
        }
        let samples = match &self.samples {
            Samples::U8(v) => Samples::U8(expand(v)),
            Samples::U16(v) => Samples::U16(expand(v)),
            Samples::F32(v) => Samples::F32(expand(v)),
        };
        Self { channels: 4, samples, ..self }
    }
}

/// The largest magnitude of a colour: the largest half float. glTF's roughness, metalness and occlusion are between 0
/// and 1, so that larger values have no meaning. Their averages must still be finite in every texture format.
const LARGEST_COLOUR: f32 = 65504.0;

impl Image {
    /// Clamps all colours to +-65504.
    ///
    /// # Errors
    /// Returns [`MapError::NotFinite`] if a sample is NaN or infinite.
    pub fn into_finite_colours(mut self) -> Result<Self, MapError> {
        self.check_finite()?;
        if let Samples::F32(samples) = &mut self.samples {
            samples.par_iter_mut().for_each(|sample| *sample = sample.clamp(-LARGEST_COLOUR, LARGEST_COLOUR));
        }
        Ok(self)
    }
}

/// An image read as RGBA: one channel is grey, two are red and green, alpha is 1 where there is none.
#[derive(Clone, Copy)]
pub struct Rgba<'a>(pub &'a Image);

impl TexelRows for Rgba<'_> {
    type Texel = [f32; 4];

    fn width(&self) -> u32 {
        self.0.width
    }

    fn height(&self) -> u32 {
        self.0.height
    }

    fn row(&self, y: u32, out: &mut [[f32; 4]]) {
        let channels = self.0.channels as usize;
        let start = y as usize * out.len() * channels;
        let samples = start..start + out.len() * channels;
        match &self.0.samples {
            Samples::U8(all) => expand(&all[samples], channels, out, |v| UNORM8[usize::from(v)]),
            Samples::U16(all) => expand(&all[samples], channels, out, |v| f32::from(v) / 65535.0),
            Samples::F32(all) => expand(&all[samples], channels, out, |v| v),
        }
    }
}

impl Rgba<'_> {
    /// Writes the green of row `y` to `out`.
    pub fn green(&self, y: u32, out: &mut [f32]) {
        let channels = self.0.channels as usize;
        let start = y as usize * out.len() * channels;
        match &self.0.samples {
            Samples::U8(all) => green(&all[start..], channels, out, |v| UNORM8[usize::from(v)]),
            Samples::U16(all) => green(&all[start..], channels, out, |v| f32::from(v) / 65535.0),
            Samples::F32(all) => green(&all[start..], channels, out, |v| v),
        }
    }

    /// Returns red and blue if both are constant over the image.
    pub fn common_red_blue(&self) -> Option<[f32; 2]> {
        let [red, _, blue] = self.0.colour_ranges().map(constant);
        Some([red?, blue?])
    }

    /// Returns green if it is constant over the image.
    pub fn common_green(&self) -> Option<f32> {
        constant(self.0.colour_ranges()[1])
    }
}

/// Returns the value of a range of one value.
fn constant([least, largest]: [f32; 2]) -> Option<f32> {
    (least == largest).then_some(least)
}

impl Image {
    /// Returns whether all texels are equal.
    pub fn is_constant(&self) -> bool {
        fn all_equal<T: Copy + PartialEq + Sync>(samples: &[T], channels: usize) -> bool {
            let (first, size) = (&samples[..channels], channels << 12);
            samples.par_chunks(size).all(|texels| texels.chunks_exact(channels).all(|texel| texel == first))
        }
        let channels = self.channels as usize;
        match &self.samples {
            Samples::U8(all) => all_equal(all, channels),
            Samples::U16(all) => all_equal(all, channels),
            Samples::F32(all) => all_equal(all, channels),
        }
    }

    /// Returns the least and the largest red, green and blue, read as in [`Rgba`].
    pub fn colour_ranges(&self) -> [[f32; 2]; 3] {
        let channels = self.channels as usize;
        let channel_ranges: Vec<[f32; 2]> = match &self.samples {
            Samples::U8(all) => ranges(all, channels, |v| UNORM8[usize::from(v)]),
            Samples::U16(all) => ranges(all, channels, |v| f32::from(v) / 65535.0),
            Samples::F32(all) => ranges(all, channels, |v| v),
        };
        match channel_ranges[..] {
            [grey] => [grey; 3],
            [red, green] => [red, green, [0.0; 2]],
            [red, green, blue, ..] => [red, green, blue],
            [] => [[0.0; 2]; 3],
        }
    }
}

/// Samples that are compared with as many others side by side: a multiple of each number of channels.
const PERIOD: usize = 192;

/// Returns the least and the largest sample of each channel.
fn ranges<T: Copy + PartialOrd + Send + Sync>(
    samples: &[T],
    channels: usize,
    value: impl Fn(T) -> f32,
) -> Vec<[f32; 2]> {
    let first: [T; PERIOD] = from_fn(|i| samples[i % channels]);
    let widen = |low: &mut [T; PERIOD], high: &mut [T; PERIOD], samples: &[T]| {
        for ((low, high), sample) in low.iter_mut().zip(high).zip(samples) {
            *low = if *sample < *low { *sample } else { *low };
            *high = if *sample > *high { *sample } else { *high };
        }
    };
    let in_chunk = |samples: &[T]| {
        let (mut low, mut high) = (first, first);
        samples.chunks(PERIOD).for_each(|samples| widen(&mut low, &mut high, samples));
        (low, high)
    };
    let (low, high) = samples.par_chunks(PERIOD << 8).map(in_chunk).reduce(
        || (first, first),
        |(mut low, mut high), other| {
            widen(&mut low, &mut high, &other.0);
            widen(&mut low, &mut high, &other.1);
            (low, high)
        },
    );
    let of_channel = |channel: usize| {
        let places = (channel..PERIOD).step_by(channels);
        places.fold([value(low[channel]), value(high[channel])], |[least, largest], i| {
            [least.min(value(low[i])), largest.max(value(high[i]))]
        })
    };
    (0..channels).map(of_channel).collect()
}

/// Writes green of all texels to `out`, or grey for images of one channel.
fn green<T: Copy>(samples: &[T], channels: usize, out: &mut [f32], value: impl Fn(T) -> f32) {
    match channels {
        1 => each(samples, out, |&[grey]| value(grey)),
        2 => each(samples, out, |&[_, green]| value(green)),
        3 => each(samples, out, |&[_, green, _]| value(green)),
        _ => each(samples, out, |&[_, green, _, _]| value(green)),
    }
}

fn expand<T: Copy>(samples: &[T], channels: usize, out: &mut [[f32; 4]], value: impl Fn(T) -> f32) {
    match channels {
        1 => each(samples, out, |&[grey]| [value(grey), value(grey), value(grey), 1.0]),
        2 => each(samples, out, |&[red, green]| [value(red), value(green), 0.0, 1.0]),
        3 => each(samples, out, |&[red, green, blue]| [value(red), value(green), value(blue), 1.0]),
        _ => each(samples, out, |texel: &[T; 4]| texel.map(&value)),
    }
}

/// Applies `of` to each texel of N samples and writes the results to `out`.
pub(crate) fn each<T, O, const N: usize>(samples: &[T], out: &mut [O], of: impl Fn(&[T; N]) -> O) {
    for (out, texel) in out.iter_mut().zip(samples.as_chunks::<N>().0) {
        *out = of(texel);
    }
}

/// n / 255 for each n. Divisions would take longer than all other work of reading a row.
static UNORM8: [f32; 256] = unorm8();

const fn unorm8() -> [f32; 256] {
    let mut values = [0.0; 256];
    let mut n = 0;
    while n < 256 {
        values[n] = n as f32 / 255.0;
        n += 1;
    }
    values
}

#[cfg(test)]
mod tests;
