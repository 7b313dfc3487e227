//! Every format that is decoded, from hand-written bytes.

use ktx2::{ColorModel, Format};

use crate::image::{Image, Samples};
use crate::ktx2::error::ReadError;
use crate::ktx2::read::Ktx2;
use crate::ktx2::test_files::{ETC1S, File, descriptor, etc1s_texel, plain};

fn decode(format: Format, size: (u32, u32), payload: &[u8]) -> Image {
    let file = plain(format, size, &[payload]).encode();
    Ktx2::parse(&file).unwrap().decode_level(0).unwrap()
}

#[test]
fn unorm8_and_srgb_keep_their_bytes_and_blue_first_is_swapped() {
    let payload: Vec<u8> = (0..24).collect();
    for (format, channels) in [
        (Format::R8_UNORM, 1),
        (Format::R8_SRGB, 1),
        (Format::R8G8_UNORM, 2),
        (Format::R8G8B8_UNORM, 3),
        (Format::R8G8B8_SRGB, 3),
        (Format::R8G8B8A8_UNORM, 4),
        (Format::R8G8B8A8_SRGB, 4),
    ] {
        let payload = &payload[..6 * channels];
        let found = decode(format, (3, 2), payload);
        let facts = (found.width, found.height, found.channels);
        assert_eq!(facts, (3, 2, channels as u32), "{format:?}");
        assert_eq!(found.samples, Samples::U8(payload.to_vec()), "{format:?}");
    }
    let rgb = decode(Format::B8G8R8_UNORM, (2, 1), &[1, 2, 3, 4, 5, 6]);
    assert_eq!(rgb.samples, Samples::U8(vec![3, 2, 1, 6, 5, 4]));
    let rgba = decode(Format::B8G8R8A8_SRGB, (1, 1), &[1, 2, 3, 4]);
    assert_eq!(rgba.samples, Samples::U8(vec![3, 2, 1, 4]));
}

#[test]
fn snorm_decodes_to_floats_from_minus_one_to_one() {
    let found = decode(Format::R8G8_SNORM, (2, 1), &[127, 0, 0x81, 0x80]);
    assert_eq!(found.samples, Samples::F32(vec![1.0, 0.0, -1.0, -1.0]));
    let found = decode(Format::R16_SNORM, (3, 1), &[0xff, 0x7f, 0, 0x80, 0, 0]);
    assert_eq!(found.samples, Samples::F32(vec![1.0, -1.0, 0.0]));
}

#[test]
fn decodes_sixteen_bits_halves_and_floats() {
    let found = decode(Format::R16G16_UNORM, (1, 1), &[0x34, 0x12, 0xff, 0xff]);
    assert_eq!(found.samples, Samples::U16(vec![0x1234, 0xffff]));
    // 1.5, -2, infinity.
    let halves = [0x00, 0x3e, 0x00, 0xc0, 0x00, 0x7c];
    let found = decode(Format::R16G16B16_SFLOAT, (1, 1), &halves);
    assert_eq!(found.samples, Samples::F32(vec![1.5, -2.0, f32::INFINITY]));
    let floats: Vec<u8> = [0.1f32, -7.25, 3e30, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let found = decode(Format::R32G32B32A32_SFLOAT, (1, 1), &floats);
    assert_eq!(found.samples, Samples::F32(vec![0.1, -7.25, 3e30, 0.0]));
}

#[test]
fn decodes_packed_floats() {
    // 2^(16-15-9) = 2^-8 times the mantissas 256, 128 and 1. The exponent has 5 bits, each mantissa 9.
    let word = 16u32 << 27 | 1 << 18 | 128 << 9 | 256;
    let found = decode(Format::E5B9G9R9_UFLOAT_PACK32, (1, 1), &word.to_le_bytes());
    assert_eq!(found.samples, Samples::F32(vec![1.0, 0.5, 1.0 / 256.0]));
    // Exponent 15 is 2^0 and 16 is 2^1. Red and green have 6 bits of mantissa, blue has 5.
    let word = (16 << 5 | 16u32) << 22 | (15 << 6 | 32) << 11 | 15 << 6;
    let found = decode(Format::B10G11R11_UFLOAT_PACK32, (1, 1), &word.to_le_bytes());
    assert_eq!(found.samples, Samples::F32(vec![1.0, 1.5, 3.0]));
}

#[test]
fn decodes_bc1_with_and_without_alpha() {
    // End points blue and red in 5:6:5. The first is below the second, so there are three colours and black.
    let block = [0x1f, 0x00, 0x00, 0xf8, 0b11_10_01_00, 0, 0, 0];
    let rgba = decode(Format::BC1_RGBA_UNORM_BLOCK, (4, 1), &block);
    let (blue, red) = ([0, 0, 255, 255], [255, 0, 0, 255]);
    let expected = [blue, red, [128, 0, 128, 255], [0, 0, 0, 0]];
    assert_close(&rgba, 4, &expected.concat(), 1);
    let rgb = decode(Format::BC1_RGB_UNORM_BLOCK, (4, 1), &block);
    assert_close(&rgb, 3, &[0, 0, 255, 255, 0, 0, 128, 0, 128, 0, 0, 0], 1);
}

fn assert_close(found: &Image, channels: u32, expected: &[u8], tolerance: u8) {
    assert_eq!(found.channels, channels);
    let Samples::U8(values) = &found.samples else {
        panic!("8 bits expected");
    };
    assert_eq!(values.len(), expected.len());
    for (found, expected) in values.iter().zip(expected) {
        assert!(found.abs_diff(*expected) <= tolerance, "{values:?}");
    }
}

#[test]
fn bc2_bc3_and_bc7_have_alpha() {
    let color = [0xff, 0xff, 0, 0, 0, 0, 0, 0];
    let bc2 = decode(Format::BC2_UNORM_BLOCK, (2, 1), &[&[0xf0; 8][..], &color].concat());
    assert_close(&bc2, 4, &[255, 255, 255, 0, 255, 255, 255, 255], 0);
    let alpha = [200, 100, 0b1000, 0, 0, 0, 0, 0];
    let bc3 = decode(Format::BC3_SRGB_BLOCK, (2, 1), &[alpha, color].concat());
    assert_close(&bc3, 4, &[255, 255, 255, 200, 255, 255, 255, 100], 0);
    // Mode 5 (six zeros, a one), rotation 0, equal end points of each channel, indices 0.
    let (red, green, blue, alpha) = (0b1010101u128, 0b0000000, 0b1111111, 0x81);
    let mut block = 1 << 5;
    for (i, value) in [red, green, blue].into_iter().enumerate() {
        block |= (value | value << 7) << (8 + 14 * i);
    }
    block |= (alpha | alpha << 8) << 50;
    let bc7 = decode(Format::BC7_UNORM_BLOCK, (1, 1), &block.to_le_bytes());
    assert_close(&bc7, 4, &[0b10101011, 0, 255, 0x81], 0);
}

#[test]
fn bc4_and_bc5_keep_more_than_8_bits() {
    // Index 2 is six sevenths of the first end point and one seventh of the second.
    let block = [255, 0, 0b00_010_001, 0, 0, 0, 0, 0];
    let bc4 = decode(Format::BC4_UNORM_BLOCK, (3, 1), &block);
    assert_eq!(bc4.samples, Samples::U16(vec![0, 56173, 65535]));
    let bc5 = decode(Format::BC5_UNORM_BLOCK, (1, 1), &[block, [51, 51, 0, 0, 0, 0, 0, 0]].concat());
    assert_eq!(bc5.channels, 2);
    assert_eq!(bc5.samples, Samples::U16(vec![0, 13107]));
    let signed = [127, 0x80, 0b00_000_001, 0, 0, 0, 0, 0];
    let bc4 = decode(Format::BC4_SNORM_BLOCK, (2, 1), &signed);
    assert_eq!(bc4.samples, Samples::F32(vec![-1.0, 1.0]));
}

#[test]
fn bc6h_decodes_to_floats() {
    // Mode 11 (00011): 10-bit end points of red, then green, then blue. Both end points have one value.
    let value = 0x200u128;
    let mut block = 0b00011;
    for i in 0..6 {
        block |= value << (5 + 10 * i);
    }
    let found = decode(Format::BC6H_UFLOAT_BLOCK, (1, 1), &block.to_le_bytes());
    assert_eq!(found.channels, 3);
    // ((0x200 << 16) + 0x8000) >> 10 is 0x8020; times 31/64 this is 0x3e0f, the half 1.5146484.
    let expected = half::f16::from_bits(0x3e0f).to_f32();
    assert_eq!(found.samples, Samples::F32(vec![expected; 3]));
}

#[test]
fn block_formats_of_odd_sizes_are_clipped() {
    // 4 blocks of one value each: 10 and 20 above, 30 and 40 below.
    let payload: Vec<u8> = [10, 20, 30, 40].iter().flat_map(|&v| [v, v, 0, 0, 0, 0, 0, 0]).collect();
    let found = decode(Format::BC4_UNORM_BLOCK, (5, 6), &payload);
    for y in 0..6 {
        for x in 0..5 {
            let expected = [[10.0, 20.0], [30.0, 40.0]][y as usize / 4][x as usize / 4] / 255.0;
            assert_eq!(found.sample(x, y, 0), Some(expected));
        }
    }
}

/// Returns a UASTC block of mode 8: one colour (Basis Universal UASTC specification, mode 8).
fn solid([r, g, b, a]: [u8; 4]) -> [u8; 16] {
    let color = u128::from(u32::from_le_bytes([r, g, b, a]));
    (0b10111 | color << 5).to_le_bytes()
}

#[test]
fn uastc_decodes_the_channels_of_its_descriptor() {
    let payload = [solid([1, 2, 3, 4]), solid([50, 60, 70, 80])].concat();
    for (channel, kept) in [(0, &[0, 1, 2][..]), (3, &[0, 1, 2, 3]), (4, &[0]), (5, &[0, 3]), (6, &[0, 1])] {
        let mut file = plain(Format::R8_UNORM, (7, 3), &[&payload]);
        file.format = None;
        file.descriptor = descriptor(ColorModel::UASTC, &[channel], 4, 16);
        let file = file.encode();
        let found = Ktx2::parse(&file).unwrap().decode_level(0).unwrap();
        assert_eq!(found.channels, kept.len() as u32);
        for (x, color) in [(0, [1, 2, 3, 4]), (3, [1, 2, 3, 4]), (4, [50, 60, 70, 80]), (6, [50, 60, 70, 80])] {
            for (c, &channel) in kept.iter().enumerate() {
                let expected = f32::from([color[0], color[1], color[2], color[3]][channel] as u8) / 255.0;
                assert_eq!(found.sample(x, 2, c as u32), Some(expected));
            }
        }
    }
}

#[test]
fn decodes_etc1s_with_alpha_and_levels() {
    let found = Ktx2::parse(ETC1S).unwrap();
    assert_eq!(found.level_count(), 4);
    let image = found.decode_level(0).unwrap();
    assert_eq!((image.width, image.height, image.channels), (12, 12, 4));
    let mut error = 0.0;
    for (x, y) in (0..12).flat_map(|y| (0..12).map(move |x| (x, y))) {
        for (c, expected) in etc1s_texel(x, y).into_iter().enumerate() {
            let difference = image.sample(x, y, c as u32).unwrap() - f32::from(expected) / 255.0;
            error += difference.abs() / (12.0 * 12.0 * 4.0);
        }
    }
    // ETC1S has one colour and four steps of brightness for 16 texels.
    assert!(error < 0.05, "mean error {error}");
    for level in 1..4 {
        let image = found.decode_level(level).unwrap();
        assert_eq!((image.width, image.height), found.level_size(level));
        // Blue is 0.5 everywhere.
        assert!((image.sample(0, 0, 2).unwrap() - 0.5).abs() < 0.15, "level {level}");
    }
    let unsupported = found.level_bytes(0);
    assert!(matches!(unsupported, Err(ReadError::Unsupported { .. })));
}

#[test]
fn names_formats_that_are_not_decoded() {
    for (format, name) in [
        (Format::ASTC_4x4_UNORM_BLOCK, "ASTC_4x4_UNORM_BLOCK"),
        (Format::R8G8B8A8_UINT, "R8G8B8A8_UINT"),
        (Format::new(999_999).unwrap(), "Format(999999)"),
    ] {
        let file = plain(format, (4, 4), &[&[0; 16]]).encode();
        let found = Ktx2::parse(&file).unwrap();
        assert_eq!(found.format_name(), name);
        let refused = found.decode_level(0);
        assert_eq!(refused, Err(ReadError::Unsupported { what: name.into() }));
        // The payload is readable: 16 texels of 1 byte by the descriptor.
        assert_eq!(*found.level_bytes(0).unwrap(), [0; 16]);
    }
    let unknown_model = File {
        format: None,
        descriptor: descriptor(ColorModel::YUVSDA, &[0], 1, 1),
        ..plain(Format::R8_UNORM, (1, 1), &[&[0]])
    };
    let refused = Ktx2::parse(&unknown_model.encode()).unwrap().decode_level(0);
    let what = "colour model Some(YUVSDA)".to_owned();
    assert_eq!(refused, Err(ReadError::Unsupported { what }));
}
