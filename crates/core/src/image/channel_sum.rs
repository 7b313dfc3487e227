//! One number for each texel of an image: the sum of a function of each channel, read from tables.

use std::sync::Arc;

use crate::image::rgba::{Rgba, each};
use crate::image::{Image, Samples};
use crate::mip::TexelRows;

/// A function of a channel at n / 255.
type Table = [f32; 256];

/// The sums over the channels of each texel of an image, read as RGBA.
#[derive(Clone)]
pub struct ChannelSum<'a> {
    image: &'a Image,
    tables: Arc<[Table; 4]>,
}

impl<'a> ChannelSum<'a> {
    /// Sums `function(channel, value)` over the channels of each texel. Values are clamped to [0, 1]. Between multiples
    /// of 1/255 the function is interpolated; for sRGB its error is below 7e-6 (test
    /// `interpolation_changes_colours_of_16_bits_little`).
    pub fn new(image: &'a Image, function: impl Fn(usize, f64) -> f64) -> Self {
        let table = |channel| std::array::from_fn(|n| function(channel, n as f64 / 255.0) as f32);
        Self { image, tables: Arc::new(std::array::from_fn(table)) }
    }

    /// Returns the sum of the first texel if all texels of the image are equal.
    pub fn constant(&self) -> Option<f32> {
        let mut row = vec![[0.0]; self.image.width as usize];
        self.image.is_constant().then(|| {
            self.row(0, &mut row);
            row[0][0]
        })
    }

    fn of_bytes(&self, channels: [u8; 4]) -> f32 {
        let at = |channel: usize| self.tables[channel][usize::from(channels[channel])];
        at(0) + at(1) + at(2) + at(3)
    }

    fn interpolated(&self, channels: [f32; 4]) -> f32 {
        let at = |channel: usize| {
            let position = 255.0 * channels[channel].clamp(0.0, 1.0);
            let below = (position as usize).min(254);
            let (table, fraction) = (&self.tables[channel], position - below as f32);
            table[below] + fraction * (table[below + 1] - table[below])
        };
        at(0) + at(1) + at(2) + at(3)
    }
}

impl TexelRows for ChannelSum<'_> {
    type Texel = [f32; 1];

    fn width(&self) -> u32 {
        self.image.width
    }

    fn height(&self) -> u32 {
        self.image.height
    }

    fn row(&self, y: u32, out: &mut [[f32; 1]]) {
        let channels = self.image.channels as usize;
        let Samples::U8(all) = &self.image.samples else {
            let mut texels = vec![[0.0; 4]; out.len()];
            Rgba(self.image).row(y, &mut texels);
            out.iter_mut().zip(texels).for_each(|(sum, texel)| *sum = [self.interpolated(texel)]);
            return;
        };
        let samples = &all[y as usize * out.len() * channels..];
        match channels {
            1 => each(samples, out, |&[grey]| [self.of_bytes([grey, grey, grey, 255])]),
            2 => each(samples, out, |&[red, green]| [self.of_bytes([red, green, 0, 255])]),
            3 => each(samples, out, |&[red, green, blue]| [self.of_bytes([red, green, blue, 255])]),
            _ => each(samples, out, |texel: &[u8; 4]| [self.of_bytes(*texel)]),
        }
    }
}

#[cfg(test)]
mod tests;
