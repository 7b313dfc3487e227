//! Small files in every format, made here so that their texels are known.

use std::io::{Cursor, Write};

use ::exr::prelude as openexr;
use ::exr::prelude::{WritableImage, f16};
use ::image::{ExtendedColorType, ImageEncoder};

/// Returns a value that differs between neighbours, rows and channels.
pub(super) fn value(x: usize, y: usize, c: usize) -> u8 {
    (x * 37 + y * 59 + c * 101 + 7) as u8
}

/// Returns `width * height * channels` interleaved values.
pub(super) fn values(width: usize, height: usize, channels: usize) -> Vec<u8> {
    let at = |i: usize| (i / channels % width, i / channels / width, i % channels);
    let of = |(x, y, c)| value(x, y, c);
    (0..width * height * channels).map(|i| of(at(i))).collect()
}

/// Returns [`values`] scaled to 16 bits, with low bytes that differ from the high bytes.
pub(super) fn values16(width: usize, height: usize, channels: usize) -> Vec<u16> {
    let widen = |v: u8| u16::from_be_bytes([v, v.wrapping_mul(3)]);
    let values = values(width, height, channels);
    values.into_iter().map(widen).collect()
}

/// A PNG written by hand: every colour type and depth, interlaced (Adam7) or not. `sample` gives
/// the stored value.
pub(super) struct Png<'a> {
    pub size: (usize, usize),
    pub color: u8,
    pub depth: u8,
    pub interlaced: bool,
    /// Chunks between the header and the data: `PLTE`, `tRNS` and others.
    pub chunks: &'a [(&'a [u8; 4], &'a [u8])],
}

impl Png<'_> {
    pub fn encode(&self, sample: impl Fn(usize, usize, usize) -> u16) -> Vec<u8> {
        const ADAM7: [[usize; 4]; 7] =
            [[0, 0, 8, 8], [4, 0, 8, 8], [0, 4, 4, 8], [2, 0, 4, 4], [0, 2, 2, 4], [1, 0, 2, 2], [0, 1, 1, 2]];
        let (width, height) = self.size;
        let channels = [1, 0, 3, 1, 2, 0, 4][usize::from(self.color)];
        let passes = if self.interlaced { ADAM7.to_vec() } else { vec![[0, 0, 1, 1]] };
        let mut raw = Vec::new();
        for [left, top, right, down] in passes {
            let columns: Vec<usize> = (left..width).step_by(right).collect();
            if columns.is_empty() {
                continue;
            }
            for y in (top..height).step_by(down) {
                raw.push(0);
                let (mut byte, mut bits) = (0u16, 0);
                for &x in &columns {
                    for c in 0..channels {
                        match self.depth {
                            16 => raw.extend(sample(x, y, c).to_be_bytes()),
                            depth => {
                                byte = byte << depth | sample(x, y, c);
                                bits += depth;
                                if bits == 8 {
                                    raw.push(byte as u8);
                                    (byte, bits) = (0, 0);
                                }
                            }
                        }
                    }
                }
                if bits > 0 {
                    raw.push((byte << (8 - bits)) as u8);
                }
            }
        }
        let mut deflated = flate2::write::ZlibEncoder::new(Vec::new(), Default::default());
        deflated.write_all(&raw).unwrap();
        let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
        let mut header = Vec::new();
        header.extend((width as u32).to_be_bytes());
        header.extend((height as u32).to_be_bytes());
        header.extend([self.depth, self.color, 0, 0, self.interlaced.into()]);
        png_chunk(&mut file, b"IHDR", &header);
        for (kind, data) in self.chunks {
            png_chunk(&mut file, kind, data);
        }
        png_chunk(&mut file, b"IDAT", &deflated.finish().unwrap());
        png_chunk(&mut file, b"IEND", &[]);
        file
    }
}

fn png_chunk(file: &mut Vec<u8>, kind: &[u8; 4], data: &[u8]) {
    file.extend((data.len() as u32).to_be_bytes());
    let mut checksum = flate2::Crc::new();
    checksum.update(kind);
    checksum.update(data);
    file.extend(kind);
    file.extend(data);
    file.extend(checksum.sum().to_be_bytes());
}

/// Encodes [`values`] as an 8-bit RGB PNG.
pub(super) fn png(width: usize, height: usize) -> Vec<u8> {
    let png = Png { size: (width, height), color: 2, depth: 8, interlaced: false, chunks: &[] };
    png.encode(|x, y, c| value(x, y, c).into())
}

/// Encodes a JPEG of 16 x 16 texels, all `color`: lossless but for colour conversion.
pub(super) fn jpeg(color: &[u8], progressive: bool) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = jpeg_encoder::Encoder::new(&mut file, 100);
    encoder.set_progressive(progressive);
    let kind = match color.len() {
        1 => jpeg_encoder::ColorType::Luma,
        _ => jpeg_encoder::ColorType::Rgb,
    };
    encoder.encode(&color.repeat(256), 16, 16, kind).unwrap();
    file
}

/// Encodes a TGA with run lengths.
pub(super) fn tga(width: usize, height: usize) -> Vec<u8> {
    let mut file = Vec::new();
    let encoder = ::image::codecs::tga::TgaEncoder::new(&mut file);
    let (w, h) = (width as u32, height as u32);
    encoder.write_image(&values(width, height, 3), w, h, ExtendedColorType::Rgb8).unwrap();
    file
}

/// Encodes a lossless WebP.
pub(super) fn webp(width: usize, height: usize, color: ExtendedColorType) -> Vec<u8> {
    let mut file = Vec::new();
    let encoder = ::image::codecs::webp::WebPEncoder::new_lossless(&mut file);
    let channels = usize::from(color.channel_count());
    let (w, h) = (width as u32, height as u32);
    encoder.write_image(&values(width, height, channels), w, h, color).unwrap();
    file
}

/// Encodes a Radiance file. Its shared exponent stores powers of two exactly.
pub(super) fn hdr(texels: &[[f32; 3]], width: usize, height: usize) -> Vec<u8> {
    let mut file = Vec::new();
    let texels: Vec<_> = texels.iter().map(|&t| ::image::Rgb(t)).collect();
    ::image::codecs::hdr::HdrEncoder::new(&mut file).encode(&texels, width, height).unwrap();
    file
}

/// Encodes a TIFF of one colour type.
pub(super) fn tiff<C>(width: usize, height: usize, data: &[C::Inner]) -> Vec<u8>
where
    C: ::tiff::encoder::colortype::ColorType,
    [C::Inner]: ::tiff::encoder::TiffValue,
{
    let mut file = Cursor::new(Vec::new());
    ::tiff::encoder::TiffEncoder::new(&mut file).unwrap().write_image::<C>(width as u32, height as u32, data).unwrap();
    file.into_inner()
}

/// One layer of an EXR file: its name and its channels, each a name and its samples.
pub(super) type ExrLayer<'a> = (Option<&'a str>, Vec<(&'a str, openexr::FlatSamples)>);

/// Encodes an EXR file with one part for each layer.
pub(super) fn exr((width, height): (usize, usize), encoding: openexr::Encoding, layers: Vec<ExrLayer>) -> Vec<u8> {
    let layers = layers.into_iter().map(|(name, channels)| {
        let channels = channels.into_iter().map(|(name, samples)| openexr::AnyChannel::new(name, samples));
        openexr::Layer::new(
            (width, height),
            match name {
                Some(name) => openexr::LayerAttributes::named(name),
                None => openexr::LayerAttributes::default(),
            },
            encoding,
            openexr::AnyChannels::sort(channels.collect()),
        )
    });
    let bounds = openexr::IntegerBounds::from_dimensions((width, height));
    let image = openexr::Image::from_layers(openexr::ImageAttributes::new(bounds), layers.collect::<Vec<_>>());
    let mut file = Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut file).unwrap();
    file.into_inner()
}

/// Returns half floats of channel `c`, exact in 16 bits.
pub(super) fn halves(width: usize, height: usize, c: usize) -> openexr::FlatSamples {
    let at = |i| f16::from_f32(exr_value(i % width, i / width, c));
    openexr::FlatSamples::F16((0..width * height).map(at).collect())
}

/// Returns the value that [`halves`] holds.
pub(super) fn exr_value(x: usize, y: usize, c: usize) -> f32 {
    f32::from(value(x, y, c)) / 64.0 - 2.0
}
