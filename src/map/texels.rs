//! Images as rows of RGBA values, as a shader reads them.

use super::{Image, Samples};
use crate::pyramid::Rows;

/// An image read as RGBA: one channel is grey, two are red and green, alpha is 1 where there is none.
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
            Samples::U8(all) => expand(&all[samples], channels, out, |v| f32::from(v) / 255.0),
            Samples::U16(all) => expand(&all[samples], channels, out, |v| f32::from(v) / 65535.0),
            Samples::F32(all) => expand(&all[samples], channels, out, |v| v),
        }
    }
}

fn expand<T: Copy>(samples: &[T], channels: usize, out: &mut [[f32; 4]], value: impl Fn(T) -> f32) {
    for (rgba, texel) in out.iter_mut().zip(samples.chunks_exact(channels)) {
        let at = |c: usize| value(texel[c]);
        *rgba = match channels {
            1 => [at(0), at(0), at(0), 1.0],
            2 => [at(0), at(1), 0.0, 1.0],
            3 => [at(0), at(1), at(2), 1.0],
            _ => [at(0), at(1), at(2), at(3)],
        };
    }
}
