//! The UASTC encoders.

use std::hint::black_box;
use std::path::Path;

use roughcast::codec::uastc::{Effort, Metric};
use roughcast::codec::{ORM, PayloadFormat, uastc};
use roughcast::decode::decode;
use roughcast::image::{DecodeOptions, Image, Samples};
use roughcast::ktx2::{Ktx2, decode_payload};
use serde_json::Value;

use crate::Failure;
use crate::basisu::{self, Interface};
use crate::clock::Time;

/// An encoder.
#[derive(Clone, Copy)]
pub enum Encoder {
    /// Roughcast's encoder.
    Roughcast(Metric, Effort),
    /// basis_universal at a level from 0 to 4.
    Basisu(u32, Interface),
}

impl Encoder {
    /// Finds an encoder by name: `fast`, `best`, `fast rgb`, `fast surface` and so on, `level 0`, `level 0 with
    /// statistics` and so on.
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "fast" => Self::Roughcast(Metric::Direction, Effort::Fast),
            "best" => Self::Roughcast(Metric::Direction, Effort::Best),
            "fast rgb" => Self::Roughcast(Metric::Rgb, Effort::Fast),
            "best rgb" => Self::Roughcast(Metric::Rgb, Effort::Best),
            "fast surface" => Self::Roughcast(ORM, Effort::Fast),
            "best surface" => Self::Roughcast(ORM, Effort::Best),
            _ => {
                let level = name.strip_prefix("level ")?;
                match level.strip_suffix(" with statistics") {
                    Some(level) => Self::Basisu(level.parse().ok()?, Interface::Statistics),
                    None => Self::Basisu(level.parse().ok()?, Interface::Plain),
                }
            }
        })
    }

    /// Encodes one level of RGBA8 texels to blocks.
    ///
    /// # Errors
    /// When basis_universal fails.
    pub fn blocks(self, rgba: &[u8], width: u32, height: u32) -> Result<Vec<u8>, Failure> {
        match self {
            Self::Roughcast(metric, effort) => {
                let image = uastc::Image::new(rgba, width, height)?;
                Ok(uastc::Encoder::new(metric, effort).encode(&image).into_flattened())
            }
            Self::Basisu(level, interface) => {
                let file = basisu::encode(rgba, width, height, level, interface)?;
                Ok(Ktx2::parse(&file)?.level_bytes(0)?.into_owned())
            }
        }
    }

    /// Decodes the level as an engine would, with Roughcast's decoder for every encoder.
    ///
    /// # Errors
    /// As [`Encoder::blocks`].
    pub fn decoded(self, rgba: &[u8], width: u32, height: u32) -> Result<Image, Failure> {
        let blocks = self.blocks(rgba, width, height)?;
        Ok(decode_payload(&blocks, PayloadFormat::UastcRgb, (width, height)).ok_or("blocks that decode")?)
    }
}

/// Times the encoder of that name on `image`, once.
///
/// # Errors
/// When the image cannot be read, or no encoder has that name.
pub fn measure(contender: &str, image: &Path) -> Result<Value, Failure> {
    let encoder = Encoder::named(contender).ok_or("an encoder's name")?;
    let (rgba, width, height) = read(image)?;
    basisu::prepare();
    let (blocks, time) = Time::of(|| encoder.blocks(black_box(&rgba), width, height));
    black_box(blocks?);
    Ok(time.to_json())
}

/// Reads an image as opaque RGBA8, with its size.
///
/// # Errors
/// When the image cannot be read.
pub fn read(image: &Path) -> Result<(Vec<u8>, u32, u32), Failure> {
    let image = decode(&std::fs::read(image)?, &DecodeOptions::default())?;
    Ok((rgba(&image), image.width, image.height))
}

/// Converts an image: grey becomes three equal channels, and alpha is dropped.
pub fn rgba(image: &Image) -> Vec<u8> {
    let channels = image.channels as usize;
    let colours = if channels < 3 { [0, 0, 0] } else { [0, 1, 2] };
    let texel = |get: &dyn Fn(usize) -> u8| [get(colours[0]), get(colours[1]), get(colours[2]), 255];
    match &image.samples {
        Samples::U8(values) if channels == 3 => {
            let mut out = vec![255; values.len() / 3 * 4];
            for (out, texel) in out.as_chunks_mut::<4>().0.iter_mut().zip(values.as_chunks::<3>().0) {
                out[..3].copy_from_slice(texel);
            }
            out
        }
        Samples::U8(values) => values.chunks_exact(channels).flat_map(|t| texel(&|c| t[c])).collect(),
        samples => {
            let byte = |i: usize| (samples.get(i).unwrap_or(0.0).clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
            (0..samples.len() / channels).flat_map(|i| texel(&|c| byte(i * channels + c))).collect()
        }
    }
}
