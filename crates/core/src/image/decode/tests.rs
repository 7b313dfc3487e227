//! Every format but EXR: texels come back as they were stored.

use crate::image::decode::DecodeOptions;
use crate::image::decode::decode_raster as decode;
use crate::image::decoded::{Image, Samples};
use crate::image::error::DecodeError;
use crate::image::format::FileFormat;
use crate::image::test_files;
use crate::image::test_files::{Png, value, values, values16};

fn read(bytes: &[u8]) -> Image {
    decode(bytes, &DecodeOptions::default()).unwrap()
}

fn image(width: u32, height: u32, channels: u32, samples: Samples) -> Image {
    Image { width, height, channels, samples }
}

#[test]
fn samples_are_normalised_by_their_depth() {
    let eight = image(2, 1, 2, Samples::U8(vec![0, 51, 255, 1]));
    assert_eq!(eight.sample(0, 0, 1), Some(0.2));
    assert_eq!(eight.sample(1, 0, 0), Some(1.0));
    assert_eq!(eight.sample(2, 0, 0), None);
    assert_eq!(eight.sample(0, 1, 0), None);
    assert_eq!(eight.sample(0, 0, 2), None);
    let sixteen = image(1, 1, 1, Samples::U16(vec![0x1234]));
    assert_eq!(sixteen.sample(0, 0, 0), Some(f32::from(0x1234u16) / 65535.0));
    assert_eq!(*sixteen.bytes(), [0x34, 0x12]);
    let float = image(1, 1, 1, Samples::F32(vec![-3.5]));
    assert_eq!(float.sample(0, 0, 0), Some(-3.5));
    assert_eq!(*float.bytes(), (-3.5f32).to_le_bytes());
}

#[test]
fn png_of_every_colour_type_and_depth_with_and_without_interlace() {
    const PALETTE: [u8; 48] = {
        let mut palette = [0; 48];
        let mut i = 0;
        while i < 48 {
            palette[i] = (i * 5 + 3) as u8;
            i += 1;
        }
        palette
    };
    const ALPHA: [u8; 2] = [9, 200];
    let size = (13, 9);
    for interlaced in [false, true] {
        for (color, depths) in
            [(0, &[1, 2, 4, 8, 16][..]), (2, &[8, 16]), (3, &[1, 2, 4, 8]), (4, &[8, 16]), (6, &[8, 16])]
        {
            for &depth in depths {
                for transparent in [false, true] {
                    let entries = 3 * (1usize << depth.min(4));
                    let palette = (b"PLTE", &PALETTE[..entries]);
                    let alpha = (b"tRNS", &ALPHA[..]);
                    let chunks = match (color, transparent) {
                        (3, false) => vec![palette],
                        (3, true) => vec![palette, alpha],
                        (_, false) => vec![],
                        (_, true) => continue,
                    };
                    let stored = |x: usize, y: usize, c: usize| match depth {
                        16 => u16::from_be_bytes([value(x, y, c), value(y, x, c)]),
                        8 if color == 3 => u16::from(value(x, y, c)) & 15,
                        _ => u16::from(value(x, y, c)) & ((1 << depth) - 1),
                    };
                    let png = Png { size, color, depth, interlaced, chunks: &chunks };
                    let found = read(&png.encode(stored));
                    let channels = match (color, transparent) {
                        (3, false) => 3,
                        (3, true) => 4,
                        _ => [1, 0, 3, 0, 2, 0, 4][usize::from(color)],
                    };
                    let expected = |x: usize, y: usize, c: usize| match (color, c) {
                        (3, 3) => u16::from(*ALPHA.get(usize::from(stored(x, y, 0))).unwrap_or(&255)),
                        (3, c) => PALETTE[usize::from(stored(x, y, 0)) * 3 + c].into(),
                        _ if depth < 8 => stored(x, y, c) * (255 / ((1 << depth) - 1)),
                        _ => stored(x, y, c),
                    };
                    let case = format!("{color} {depth} {interlaced} {transparent}");
                    assert_eq!((found.width, found.height), (13, 9), "{case}");
                    assert_eq!(found.channels, channels, "{case}");
                    assert_eq!(found.samples.bits(), u32::from(depth).max(8), "{case}");
                    for (x, y, c) in positions(&found) {
                        let scale = if depth == 16 { 65535.0 } else { 255.0 };
                        let expected = f32::from(expected(x, y, c)) / scale;
                        let sample = found.sample(x as u32, y as u32, c as u32);
                        assert_eq!(sample, Some(expected), "{case} at {x} {y} {c}");
                    }
                }
            }
        }
    }
}

fn positions(image: &Image) -> impl Iterator<Item = (usize, usize, usize)> {
    let (width, channels) = (image.width as usize, image.channels as usize);
    (0..image.samples.len()).map(move |i| (i / channels % width, i / channels / width, i % channels))
}

#[test]
fn png_gamma_and_srgb_tags_do_not_change_values() {
    let tagged = Png {
        size: (4, 4),
        color: 0,
        depth: 8,
        interlaced: false,
        chunks: &[(b"gAMA", &22727u32.to_be_bytes()), (b"sRGB", &[0])],
    };
    let found = read(&tagged.encode(|x, y, c| value(x, y, c).into()));
    assert_eq!(found.samples, Samples::U8(values(4, 4, 1)));
}

#[test]
fn png_of_16_bits_stays_at_16_bits() {
    let png = Png { size: (5, 3), color: 2, depth: 16, interlaced: false, chunks: &[] };
    let expected = values16(5, 3, 3);
    let found = read(&png.encode(|x, y, c| expected[(y * 5 + x) * 3 + c]));
    assert_eq!(found, image(5, 3, 3, Samples::U16(expected)));
}

#[test]
fn jpeg_baseline_progressive_and_grey() {
    for progressive in [false, true] {
        let grey = read(&test_files::jpeg(&[120], progressive));
        assert_eq!(grey, image(16, 16, 1, Samples::U8(vec![120; 256])));
        let rgb = read(&test_files::jpeg(&[128, 128, 255], progressive));
        assert_eq!((rgb.width, rgb.height, rgb.channels), (16, 16, 3));
        let Samples::U8(found) = rgb.samples else {
            panic!("8 bits expected");
        };
        let close = |(a, b): (&u8, &u8)| a.abs_diff(*b) <= 2;
        assert!(found.iter().zip([128, 128, 255].repeat(256).iter()).all(close));
    }
}

#[test]
fn tiff_of_8_and_16_bits_and_floats() {
    use ::tiff::encoder::colortype as tiff;
    let (w, h) = (7, 5);
    let of = |channels, samples| image(7, 5, channels, samples);
    let eight = test_files::tiff::<tiff::RGB8>(w, h, &values(w, h, 3));
    assert_eq!(read(&eight), of(3, Samples::U8(values(w, h, 3))));
    let rgba = test_files::tiff::<tiff::RGBA8>(w, h, &values(w, h, 4));
    assert_eq!(read(&rgba), of(4, Samples::U8(values(w, h, 4))));
    let grey = test_files::tiff::<tiff::Gray8>(w, h, &values(w, h, 1));
    assert_eq!(read(&grey), of(1, Samples::U8(values(w, h, 1))));
    let sixteen = test_files::tiff::<tiff::Gray16>(w, h, &values16(w, h, 1));
    assert_eq!(read(&sixteen), of(1, Samples::U16(values16(w, h, 1))));
    let rgb16 = test_files::tiff::<tiff::RGB16>(w, h, &values16(w, h, 3));
    assert_eq!(read(&rgb16), of(3, Samples::U16(values16(w, h, 3))));
    let heights: Vec<f32> = values(w, h, 1).iter().map(|&v| f32::from(v) * 3.7 - 99.0).collect();
    let float = test_files::tiff::<tiff::Gray32Float>(w, h, &heights);
    assert_eq!(read(&float), of(1, Samples::F32(heights)));
    let normals: Vec<f32> = values(w, h, 3).iter().map(|&v| f32::from(v) / 256.0).collect();
    let float = test_files::tiff::<tiff::RGB32Float>(w, h, &normals);
    assert_eq!(read(&float), of(3, Samples::F32(normals)));
    let signed = test_files::tiff::<tiff::GrayI16>(w, h, &[-5; 35]);
    let refused = decode(&signed, &DecodeOptions::default());
    assert!(matches!(refused, Err(DecodeError::Unsupported { format: FileFormat::Tiff, .. })));
}

#[test]
fn tga_needs_its_extension() {
    let file = test_files::tga(9, 6);
    let mut options = DecodeOptions::default();
    let unknown = decode(&file, &options);
    assert!(matches!(unknown, Err(DecodeError::UnknownFormat { start }) if start == file[..8]));
    options.extension = Some("TGA".into());
    let expected = image(9, 6, 3, Samples::U8(values(9, 6, 3)));
    assert_eq!(decode(&file, &options), Ok(expected));
}

#[test]
fn a_signature_outranks_the_extension() {
    let options = DecodeOptions { extension: Some("tga".into()), ..DecodeOptions::default() };
    assert_eq!(decode(&test_files::png(3, 2), &options).unwrap().channels, 3);
}

#[test]
fn webp_lossless_and_lossy() {
    use ::image::ExtendedColorType::{Rgb8, Rgba8};
    let rgb = read(&test_files::webp(6, 4, Rgb8));
    assert_eq!(rgb, image(6, 4, 3, Samples::U8(values(6, 4, 3))));
    let rgba = read(&test_files::webp(6, 4, Rgba8));
    assert_eq!(rgba, image(6, 4, 4, Samples::U8(values(6, 4, 4))));
    // One black texel: a key frame with its two partitions.
    let lossy = b"RIFF\x22\0\0\0WEBPVP8 \x16\0\0\0\x30\x01\0\x9d\x01\x2a\x01\0\x01\0\x0e\xc0\xfe\
                  \x25\xa4\0\x03\x70\0\0\0\0";
    let lossy = read(lossy);
    assert_eq!((lossy.width, lossy.height, lossy.channels), (1, 1, 3));
}

#[test]
fn radiance_hdr() {
    let texels: Vec<[f32; 3]> = (0..24).map(|i| [0.5, 2.0, i as f32 / 16.0]).collect();
    let found = read(&test_files::hdr(&texels, 8, 3));
    assert_eq!((found.width, found.height, found.channels), (8, 3, 3));
    // The largest of a texel has 8 bits of its own, the others share its exponent.
    for (i, texel) in texels.iter().enumerate() {
        for (c, &expected) in texel.iter().enumerate() {
            let sample = found.samples.get(i * 3 + c).unwrap();
            assert!((sample - expected).abs() <= 1.0 / 64.0, "{i} {c}: {sample}");
        }
    }
}

#[test]
fn files_of_the_shared_data_when_they_are_there() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/");
    for (name, width, height, channels) in [
        ("maps/aluminium_normal.png", 745, 745, 3),
        ("maps/water_normals.png", 512, 512, 4),
        ("maps/sand_normal.jpg", 1024, 1024, 3),
        ("AnisotropyBarnLamp/AnisotropyBarnLamp_normalbump.ktx2", 1024, 1024, 3),
    ] {
        let Ok(bytes) = std::fs::read(format!("{folder}{name}")) else {
            crate::skip::skip(&format!("{folder}{name} does not exist"));
            continue;
        };
        let found = crate::decode::decode(&bytes, &DecodeOptions::default()).unwrap();
        let expected = (width, height, channels, 8);
        let facts = (found.width, found.height, found.channels, found.samples.bits());
        assert_eq!(facts, expected, "{name}");
    }
}
