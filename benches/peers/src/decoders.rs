//! Decoders of PNG and JPEG that Roughcast might use, on a file in memory.

use std::hint::black_box;
use std::io::Cursor;
use std::path::Path;

use roughcast::decode::decode;
use roughcast::image::DecodeOptions;
use serde_json::Value;
use zune_core::options::DecoderOptions;

use crate::Failure;
use crate::clock::Time;

/// Largest side of an image that zune's decoders accept. No input has a larger side.
const MAX_SIDE: usize = 1 << 16;

/// Times `decoder` once.
///
/// # Errors
/// When the file cannot be decoded, or no decoder has that name.
pub fn measure(decoder: &str, image: &Path) -> Result<Value, Failure> {
    let file = std::fs::read(image)?;
    let file = black_box(file.as_slice());
    let (texels, time) = match decoder {
        "roughcast" => Time::of(|| roughcast(file)),
        "png" => Time::of(|| png(file)),
        "zune-png" => Time::of(|| zune_png(file)),
        "zune-jpeg" => Time::of(|| zune_jpeg(file)),
        "jpeg-decoder" => Time::of(|| jpeg_decoder(file)),
        _ => return Err("expected roughcast, png, zune-png, zune-jpeg or jpeg-decoder".into()),
    };
    black_box(texels?);
    Ok(time.to_json())
}

/// Times Roughcast's decoders on the images of a bake, `in turn` or `side by side`.
///
/// # Errors
/// When a file cannot be decoded, or the order is neither of the two.
pub fn images(order: &str, images: [&Path; 2]) -> Result<Value, Failure> {
    let [first, second] = images.map(std::fs::read);
    let (first, second) = (first?, second?);
    let decoded = |file: &[u8]| decode(black_box(file), &DecodeOptions::default());
    let ((first, second), time) = match order {
        "in turn" => Time::of(|| (decoded(&first), decoded(&second))),
        "side by side" => Time::of(|| rayon::join(|| decoded(&first), || decoded(&second))),
        _ => return Err("expected in turn or side by side".into()),
    };
    black_box((first?, second?));
    Ok(time.to_json())
}

fn roughcast(file: &[u8]) -> Result<Vec<u8>, Failure> {
    Ok(decode(file, &DecodeOptions::default())?.bytes().into_owned())
}

fn png(file: &[u8]) -> Result<Vec<u8>, Failure> {
    let mut reader = png::Decoder::new(Cursor::new(file)).read_info()?;
    let mut texels = vec![0; reader.output_buffer_size().ok_or("an image that fits memory")?];
    reader.next_frame(&mut texels)?;
    Ok(texels)
}

/// As large as the inputs are.
fn options() -> DecoderOptions {
    DecoderOptions::default().set_max_width(MAX_SIDE).set_max_height(MAX_SIDE)
}

fn zune_png(file: &[u8]) -> Result<Vec<u8>, Failure> {
    let mut decoder = zune_png::PngDecoder::new_with_options(Cursor::new(file), options());
    Ok(decoder.decode_raw().map_err(|error| format!("{error:?}"))?)
}

fn zune_jpeg(file: &[u8]) -> Result<Vec<u8>, Failure> {
    Ok(zune_jpeg::JpegDecoder::new_with_options(Cursor::new(file), options()).decode()?)
}

fn jpeg_decoder(file: &[u8]) -> Result<Vec<u8>, Failure> {
    Ok(jpeg_decoder::Decoder::new(file).decode()?)
}
