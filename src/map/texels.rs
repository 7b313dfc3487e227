//! Images as rows of RGBA values, as a shader reads them.

use super::{DecodeError, DecodeOptions, Format, Image, Samples, decode};
use crate::pyramid::Rows;

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

/// Decodes an image whose channels are colours or packed values, not a vector.
///
/// # Errors
/// Those of [`decode`].
pub fn decode_colours(bytes: &[u8], options: &DecodeOptions) -> Result<Image, DecodeError> {
    let image = decode(bytes, options)?;
    let is_red_green = matches!(Format::detect(bytes, None), Some(Format::Ktx2 | Format::Exr));
    Ok(if is_red_green { image } else { image.with_grey_as_colour() })
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
    pub fn greens(&self, y: u32, out: &mut [f32]) {
        let channels = self.0.channels as usize;
        let start = y as usize * out.len() * channels + usize::from(channels > 1);
        match &self.0.samples {
            Samples::U8(all) => every(&all[start..], channels, out, |v| UNORM8[usize::from(v)]),
            Samples::U16(all) => every(&all[start..], channels, out, |v| f32::from(v) / 65535.0),
            Samples::F32(all) => every(&all[start..], channels, out, |v| v),
        }
    }
}

/// Writes every `step`th of `samples`, from the first on.
fn every<T: Copy>(samples: &[T], step: usize, out: &mut [f32], value: impl Fn(T) -> f32) {
    for (out, sample) in out.iter_mut().zip(samples.iter().step_by(step)) {
        *out = value(*sample);
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

/// Writes what `of` makes of each texel of N samples.
pub(super) fn each<T, const N: usize, const M: usize>(
    samples: &[T],
    out: &mut [[f32; M]],
    of: impl Fn(&[T; N]) -> [f32; M],
) {
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
                    let (mut texels, mut greens) = ([[0.0; 4]; 4], [0.0; 4]);
                    Rgba(&image).row(y, &mut texels);
                    Rgba(&image).greens(y, &mut greens);
                    assert_eq!(greens, texels.map(|texel| texel[1]), "{channels} channels");
                }
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
