//! Export of levels as pictures: PNG for 8 and 16 bits, EXR for floats.

use std::io::Cursor;

use ::exr::prelude as openexr;
use ::exr::prelude::WritableImage;
use image::codecs::png::PngEncoder;
use image::{ImageBuffer, Luma, Pixel, PixelWithColorType, Rgb, Rgba};

use crate::image::{Image, Samples};
use crate::ktx2::{Ktx2, ReadError};

/// A level as an image file.
pub struct Picture {
    /// Index of the level.
    pub level: u32,
    /// `png` or `exr`.
    pub extension: &'static str,
    /// The file.
    pub bytes: Vec<u8>,
}

/// Why a level cannot be extracted.
#[derive(Debug, thiserror::Error)]
pub enum ExtractError {
    /// The texture cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The image cannot be written.
    #[error("expected to encode level {level} as {extension}, found: {reason}; free memory and try again")]
    Encode {
        /// Index of the level.
        level: u32,
        /// `png` or `exr`.
        extension: &'static str,
        /// The encoder's error.
        reason: String,
    },
}

/// Exports every level of a KTX2 file, level 0 first. One channel becomes grey, two become red and green, and three or
/// four stay as they are.
///
/// # Errors
/// [`ExtractError`] for the first level that cannot be read or written.
pub fn extract(bytes: &[u8]) -> Result<Vec<Picture>, ExtractError> {
    let file = Ktx2::parse(bytes)?;
    let picture = |level| {
        let image = file.decode_level(level)?;
        let (extension, encoded) = match image.samples {
            Samples::F32(_) => ("exr", encode_exr(image)),
            Samples::U8(_) | Samples::U16(_) => ("png", png(image)),
        };
        let bytes = encoded.map_err(|reason| ExtractError::Encode { level, extension, reason })?;
        Ok(Picture { level, extension, bytes })
    };
    (0..file.level_count()).map(picture).collect()
}

fn png(image: Image) -> Result<Vec<u8>, String> {
    let Image { width, height, channels, samples } = image;
    match samples {
        Samples::U8(values) => png_of(width, height, channels, values),
        Samples::U16(values) => png_of(width, height, channels, values),
        Samples::F32(_) => Err("floats".to_owned()),
    }
}

fn png_of<T>(width: u32, height: u32, channels: u32, values: Vec<T>) -> Result<Vec<u8>, String>
where
    T: image::Primitive + Default,
    Luma<T>: PixelWithColorType<Subpixel = T>,
    Rgb<T>: PixelWithColorType<Subpixel = T>,
    Rgba<T>: PixelWithColorType<Subpixel = T>,
    [T]: image::EncodableLayout,
{
    match channels {
        1 => encode::<Luma<T>>(width, height, values),
        // As grey and alpha, viewers would hide texels whose second channel is small.
        2 => encode::<Rgb<T>>(width, height, values.chunks_exact(2).flat_map(|t| [t[0], t[1], T::default()]).collect()),
        3 => encode::<Rgb<T>>(width, height, values),
        _ => encode::<Rgba<T>>(width, height, values),
    }
}

fn encode<P>(width: u32, height: u32, values: Vec<P::Subpixel>) -> Result<Vec<u8>, String>
where
    P: Pixel + PixelWithColorType,
    [P::Subpixel]: image::EncodableLayout,
{
    let buffer = ImageBuffer::<P, _>::from_raw(width, height, values).ok_or("fewer texels than its size has")?;
    let mut file = Vec::new();
    let encoder = PngEncoder::new(&mut file);
    buffer.write_with_encoder(encoder).map_err(|e| e.to_string())?;
    Ok(file)
}

/// Encodes an image of floats as OpenEXR.
///
/// # Errors
/// The encoder's error, or that the image has integers.
pub fn encode_exr(image: Image) -> Result<Vec<u8>, String> {
    let size = (image.width as usize, image.height as usize);
    let names: &[&str] = match image.channels {
        1 => &["Y"],
        2 => &["R", "G"],
        3 => &["R", "G", "B"],
        _ => &["R", "G", "B", "A"],
    };
    let Samples::F32(values) = image.samples else { return Err("integers".to_owned()) };
    let channels = names.iter().enumerate().map(|(c, name)| {
        let samples = values.iter().skip(c).step_by(names.len()).copied().collect();
        openexr::AnyChannel::new(*name, openexr::FlatSamples::F32(samples))
    });
    let layer = openexr::Layer::new(
        size,
        openexr::LayerAttributes::default(),
        openexr::Encoding::FAST_LOSSLESS,
        openexr::AnyChannels::sort(channels.collect()),
    );
    let mut file = Cursor::new(Vec::new());
    openexr::Image::from_layer(layer).write().non_parallel().to_buffered(&mut file).map_err(|e| e.to_string())?;
    Ok(file.into_inner())
}
