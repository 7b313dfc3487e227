//! Written files, read by other readers.

use crate::codec::uastc::{Effort, Metric};
use crate::codec::{Codec, EncodeError, PayloadFormat, Texels, encode};
use crate::ktx2::read::Ktx2;
use crate::ktx2::write::{Key, Ktx2Writer, StoredLevel};
use crate::mip::level_sizes;
use ::ktx2::{ColorModel, ColorPrimaries, Reader, SupercompressionScheme, TransferFunction};

/// Returns a texture of smooth values, or `None` if this build has no encoder for the format.
fn texture(format: PayloadFormat, width: u32, height: u32, keys: &[Key]) -> Option<Vec<u8>> {
    let row = |y: u32, out: &mut [[f32; 4]]| {
        for (x, texel) in out.iter_mut().enumerate() {
            *texel = [x as f32 / width as f32, y as f32 / height as f32, 0.5, 1.0];
        }
    };
    let sizes = level_sizes(width, height);
    let levels = sizes.iter().map(|&(width, height)| {
        let level = encode(&Texels { width, height, row: &row, lobes: None }, format, Metric::Rgb, Effort::Fast)?;
        Ok(StoredLevel::new(level, format, Effort::Fast).unwrap())
    });
    let levels = levels.collect::<Result<Vec<_>, EncodeError>>().ok()?;
    Some(Ktx2Writer { format, width, height, levels, keys }.into_bytes().unwrap())
}

#[test]
fn other_readers_read_what_was_written() {
    for format in Codec::all().iter().map(|codec| codec.format) {
        let Some(file) = texture(format, 20, 12, &[]) else { continue };
        let reader = Reader::new(&file[..]).unwrap();
        let header = reader.header();
        assert_eq!((header.pixel_width, header.pixel_height, header.pixel_depth), (20, 12, 0));
        assert_eq!((header.layer_count, header.face_count, header.level_count), (0, 1, 5));
        assert_eq!(header.format, format.vulkan());
        let is_colour = matches!(format, PayloadFormat::UastcSrgb | PayloadFormat::UastcSrgbAlpha);
        let transfer = if is_colour { TransferFunction::SRGB } else { TransferFunction::Linear };
        assert_eq!(reader.transfer_function(), Some(transfer), "{format:?}");
        assert_eq!(reader.color_primaries(), is_colour.then_some(ColorPrimaries::BT709), "{format:?}");
        for (level, (width, height)) in reader.levels().zip(level_sizes(20, 12)) {
            assert_eq!(level.uncompressed_byte_length as usize, format.level_bytes(width, height));
        }
        let ours = Ktx2::parse(&file).unwrap();
        for level in 0..5 {
            assert!(ours.decode_level(level).is_ok(), "{format:?}");
        }
    }
}

/// KHR_texture_basisu asks for zstd, colour model UASTC and one RGB channel of 128 bits. A plane has 16 bytes since KTX
/// 2.0.4.
#[test]
fn uastc_follows_khr_texture_basisu() {
    let file = texture(PayloadFormat::UastcRgb, 16, 16, &[]).unwrap();
    let reader = Reader::new(&file[..]).unwrap();
    assert_eq!(reader.header().supercompression_scheme, Some(SupercompressionScheme::Zstandard));
    assert_eq!(reader.header().type_size, 1);
    let basic = reader.basic_dfd().unwrap();
    assert_eq!(basic.color_model, Some(ColorModel::UASTC));
    assert_eq!(basic.bytes_planes, [16, 0, 0, 0, 0, 0, 0, 0]);
    assert_eq!(basic.texel_block_dimensions.map(|d| d.get()), [4, 4, 1, 1]);
    let [sample] = &basic.sample_information[..] else { panic!("{basic:?}") };
    assert_eq!((sample.bit_offset, sample.bit_length.get(), sample.channel_type), (0, 128, 0));
    assert_eq!((sample.lower, sample.upper), (0, u32::MAX));
}

/// KTX 2.0, "Level Index" and "Mip Padding": the smallest level is first, and each is aligned to its texel block and to
/// 4.
#[test]
fn levels_are_stored_smallest_first_and_aligned() {
    for format in Codec::all().iter().map(|codec| codec.format) {
        let Some(file) = texture(format, 13, 7, &[]) else { continue };
        let ours = Ktx2::parse(&file).unwrap();
        let levels = ours.levels();
        assert!(levels.windows(2).all(|pair| pair[0].offset >= pair[1].offset + pair[1].length), "{format:?}");
        assert_eq!(levels[0].offset + levels[0].length, file.len() as u64);
        // Levels with supercompression need no alignment.
        if Reader::new(&file[..]).unwrap().header().supercompression_scheme.is_none() {
            let alignment = format.block_bytes().max(4) as u64;
            assert!(levels.iter().all(|level| level.offset % alignment == 0), "{format:?}");
        }
    }
}

#[test]
fn keys_are_sorted_and_end_with_nul() {
    let key = |key: &str, value: &str| Key { key: key.into(), value: value.into() };
    let file =
        texture(PayloadFormat::R16Float, 1, 1, &[key("roughcast", "{}"), key("KTXwriter", "test"), key("Az", "")]);
    let file = file.unwrap();
    let reader = Reader::new(&file[..]).unwrap();
    let pairs: Vec<(&str, &[u8])> = reader.key_value_data().collect();
    let expected: [(&str, &[u8]); 4] =
        [("Az", b"\0"), ("KTXorientation", b"rd\0"), ("KTXwriter", b"test\0"), ("roughcast", b"{}\0")];
    assert_eq!(pairs, expected);
}
