//! Images as rows of RGBA values, as a shader reads them.

use rayon::prelude::*;

use crate::image::MapError;
use crate::image::decoded::{Image, Samples};
use crate::mip::Rows;

impl Image {
    /// Grey with alpha as four channels, as engines read such files; other images as they are. Two channels of a KTX2 or an
    /// EXR are red and green and must not be passed here.
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

/// Largest magnitude of a colour: the largest half float. glTF's roughness, metalness and occlusion are from 0 to 1, so
/// that what lies beyond has no meaning; averages of it must stay numbers, whatever they are stored as.
const LARGEST_COLOUR: f32 = 65504.0;

impl Image {
    /// The image with no colour beyond +-65504.
    ///
    /// # Errors
    /// [`MapError::NotFinite`] when a sample is NaN or infinite.
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

impl Rows for Rgba<'_> {
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

    /// Red and blue, where they are the same in all texels.
    pub fn common_red_blue(&self) -> Option<[f32; 2]> {
        let channels = self.0.channels as usize;
        let are_same = match &self.0.samples {
            Samples::U8(all) => have_same_red_blue(all, channels),
            Samples::U16(all) => have_same_red_blue(all, channels),
            Samples::F32(all) => have_same_red_blue(all, channels),
        };
        let mut first = [[0.0; 4]];
        self.row(0, &mut first);
        let [[red, _, blue, _]] = first;
        are_same.then_some([red, blue])
    }
}

/// Writes the greens of texels, or what is grey, to `out`.
fn green<T: Copy>(samples: &[T], channels: usize, out: &mut [f32], value: impl Fn(T) -> f32) {
    match channels {
        1 => each(samples, out, |&[grey]| value(grey)),
        2 => each(samples, out, |&[_, green]| value(green)),
        3 => each(samples, out, |&[_, green, _]| value(green)),
        _ => each(samples, out, |&[_, green, _, _]| value(green)),
    }
}

/// Whether the first and, where there is one, the third of the channels are the same in all texels.
fn have_same_red_blue<T: Copy + PartialEq + Sync>(samples: &[T], channels: usize) -> bool {
    let [red, blue] = [samples[0], samples[if channels > 2 { 2 } else { 0 }]];
    let of_some = |texels: &[T]| match channels {
        1 => all(texels, |&[grey]| grey == red),
        2 => all(texels, |&[r, _]| r == red),
        3 => all(texels, |&[r, _, b]| (r == red) & (b == blue)),
        _ => all(texels, |&[r, _, b, _]| (r == red) & (b == blue)),
    };
    samples.par_chunks(channels << 12).all(of_some)
}

/// Whether `is_so` of every texel of N samples.
fn all<T, const N: usize>(samples: &[T], is_so: impl Fn(&[T; N]) -> bool) -> bool {
    // To the end in any case, as vectors do.
    samples.as_chunks::<N>().0.iter().fold(true, |all, texel| all & is_so(texel))
}

fn expand<T: Copy>(samples: &[T], channels: usize, out: &mut [[f32; 4]], value: impl Fn(T) -> f32) {
    match channels {
        1 => each(samples, out, |&[grey]| [value(grey), value(grey), value(grey), 1.0]),
        2 => each(samples, out, |&[red, green]| [value(red), value(green), 0.0, 1.0]),
        3 => each(samples, out, |&[red, green, blue]| [value(red), value(green), value(blue), 1.0]),
        _ => each(samples, out, |texel: &[T; 4]| texel.map(&value)),
    }
}

/// Writes what `of` makes of each texel of N samples.
pub(crate) fn each<T, O, const N: usize>(samples: &[T], out: &mut [O], of: impl Fn(&[T; N]) -> O) {
    for (out, texel) in out.iter_mut().zip(samples.as_chunks::<N>().0) {
        *out = of(texel);
    }
}

/// n / 255 for each n: divisions take longer than all the rest of reading a row.
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
mod tests {
    use super::*;

    #[test]
    fn colours_beyond_half_floats_are_clamped() {
        let image = |samples: Vec<f32>| Image { width: 2, height: 1, channels: 2, samples: Samples::F32(samples) };
        let clamped = image(vec![f32::MAX, -1e30, 0.25, 7.0]).into_finite_colours();
        assert_eq!(clamped, Ok(image(vec![65504.0, -65504.0, 0.25, 7.0])));
        assert!(image(vec![0.0, f32::NAN, 0.0, 0.0]).into_finite_colours().is_err());
    }

    #[test]
    fn greens_are_those_of_the_texels() {
        for channels in 1..=4 {
            let bytes: Vec<u8> = (0..12 * channels).map(|i| (i * 19 % 251) as u8).collect();
            let all: [Samples; 3] = [
                Samples::U16(bytes.iter().map(|&v| 257 * u16::from(v) / 2).collect()),
                Samples::F32(bytes.iter().map(|&v| f32::from(v) - 3.5).collect()),
                Samples::U8(bytes),
            ];
            for samples in all {
                let image = Image { width: 4, height: 3, channels, samples };
                for y in 0..3 {
                    let (mut texels, mut green) = ([[0.0; 4]; 4], [0.0; 4]);
                    Rgba(&image).row(y, &mut texels);
                    Rgba(&image).green(y, &mut green);
                    assert_eq!(green, texels.map(|texel| texel[1]), "{channels} channels");
                }
            }
        }
    }

    #[test]
    fn sides_are_common_where_all_texels_have_them() {
        for channels in 1..=4 {
            let mut bytes = [51, 0, 102, 7][..channels].repeat(12);
            let red_blue = |bytes: &[u8]| {
                let image =
                    Image { width: 4, height: 3, channels: channels as u32, samples: Samples::U8(bytes.to_vec()) };
                Rgba(&image).common_red_blue()
            };
            assert_eq!(red_blue(&bytes), Some([0.2, [0.2, 0.0, 0.4, 0.4][channels - 1]]), "{channels} channels");
            for c in 0..channels {
                let last = bytes.len() - channels + c;
                bytes[last] += 1;
                assert_eq!(red_blue(&bytes).is_none(), c % 2 == 0, "channel {c} of {channels}");
                bytes[last] -= 1;
            }
        }
    }

    #[test]
    fn grey_with_alpha_is_grey_in_every_colour() {
        let image = Image { width: 1, height: 1, channels: 2, samples: Samples::U8(vec![51, 7]) };
        let mut texel = [[0.0; 4]];
        Rgba(&image.clone()).row(0, &mut texel);
        assert_eq!(texel, [[0.2, 7.0 / 255.0, 0.0, 1.0]]);
        Rgba(&image.with_grey_as_colour()).row(0, &mut texel);
        assert_eq!(texel, [[0.2, 0.2, 0.2, 7.0 / 255.0]]);
    }
}
