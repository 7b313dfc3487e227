//! The container: header facts, supercompression, and files with false claims.

use std::io::Write;

use ktx2::{ColorModel, Format, SupercompressionScheme, TransferFunction};

use crate::foreign::Foreign;
use crate::image::Samples;
use crate::ktx2::error::ReadError;
use crate::ktx2::read::Ktx2;
use crate::ktx2::test_files::{ETC1S, File, descriptor, plain};

fn zstd(payload: &[u8]) -> Vec<u8> {
    ::zstd::encode_all(payload, 3).unwrap()
}

fn zlib(payload: &[u8]) -> Vec<u8> {
    let mut writer = flate2::write::ZlibEncoder::new(Vec::new(), Default::default());
    writer.write_all(payload).unwrap();
    writer.finish().unwrap()
}

fn compressed(scheme: SupercompressionScheme, stored: Vec<u8>, length: u64) -> File<'static> {
    File { scheme: Some(scheme), levels: vec![(stored, length)], ..plain(Format::R8_UNORM, (16, 16), &[]) }
}

#[test]
fn reads_the_header_levels_and_keys_as_stored() {
    let file = File {
        key_values: &[("KTXorientation", b"rd\0"), ("KTXwriter", b"by hand\0"), ("empty", b"")],
        ..plain(Format::R8G8_UNORM, (4, 2), &[&[1; 16], &[2; 4], &[3; 2]])
    };
    let file = file.encode();
    let found = Ktx2::parse(&file).unwrap();
    assert_eq!(found.format_name(), "R8G8_UNORM");
    assert_eq!((found.level_count(), found.level_size(0)), (3, (4, 2)));
    assert_eq!((found.level_size(1), found.level_size(2)), ((2, 1), (1, 1)));
    let header = found.header();
    assert_eq!((header.face_count, header.layer_count, header.pixel_depth), (1, 0, 0));
    assert_eq!(header.supercompression_scheme, None);
    let basic = found.descriptor().unwrap();
    assert_eq!(basic.color_model, Some(ColorModel::RGBSDA));
    assert_eq!(basic.transfer_function, Some(TransferFunction::Linear));
    let pairs: Vec<_> = found.key_values().collect();
    assert_eq!(pairs[1], ("KTXwriter", &b"by hand\0"[..]));
    assert_eq!((pairs.len(), pairs[2]), (3, ("empty", &b""[..])));
    for (level, value) in [1, 2, 3].into_iter().enumerate() {
        let facts = found.levels()[level];
        let length = facts.length as usize;
        let stored = &file[facts.offset as usize..][..length];
        assert_eq!(stored, vec![value; length]);
        let image = found.decode_level(level as u32).unwrap();
        assert_eq!(image.samples, Samples::U8(vec![value; length]));
    }
    for asked in [3, u32::MAX] {
        let missing = ReadError::NoLevel { asked, count: 3 };
        assert_eq!(found.decode_level(asked), Err(missing.clone()));
        assert_eq!(found.level_bytes(asked), Err(missing));
    }
}

#[test]
fn decompresses_zstd_and_zlib() {
    let payload: Vec<u8> = (0..=255).collect();
    for (scheme, stored) in
        [(SupercompressionScheme::Zstandard, zstd(&payload)), (SupercompressionScheme::ZLIB, zlib(&payload))]
    {
        let file = compressed(scheme, stored, 256).encode();
        let found = Ktx2::parse(&file).unwrap();
        assert_eq!(*found.level_bytes(0).unwrap(), payload);
        assert_eq!(found.decode_level(0).unwrap().samples, Samples::U8(payload.clone()));
    }
}

#[test]
fn refuses_decompression_bombs_and_wrong_lengths() {
    let length = |found| ReadError::LevelLength { level: 0, expected: 256, found };
    let decode = |file: File| Ktx2::parse(&file.encode()).unwrap().decode_level(0);
    for scheme in [SupercompressionScheme::Zstandard, SupercompressionScheme::ZLIB] {
        let pack = |payload: &[u8]| match scheme {
            SupercompressionScheme::ZLIB => zlib(payload),
            _ => zstd(payload),
        };
        // The bomb holds 64 MB in a few kilobytes. One byte past the level is read, and no more.
        let bomb = compressed(scheme, pack(&vec![0; 64 << 20]), 256);
        assert_eq!(decode(bomb), Err(length(257)));
        let short = compressed(scheme, pack(&[0; 255]), 256);
        assert_eq!(decode(short), Err(length(255)));
        let false_claim = compressed(scheme, pack(&[0; 256]), 1 << 40);
        assert_eq!(decode(false_claim), Err(length(1 << 40)));
        let broken = compressed(scheme, vec![1, 2, 3, 4], 256);
        assert!(matches!(decode(broken), Err(ReadError::Compression { level: 0, .. })));
    }
    let raw = plain(Format::R8_UNORM, (16, 16), &[&[0; 255]]);
    assert_eq!(decode(raw), Err(length(255)));
    let unknown = SupercompressionScheme::new(9).unwrap();
    let refused = decode(compressed(unknown, vec![0; 256], 256));
    assert!(matches!(refused, Err(ReadError::Unsupported { .. })));
}

#[test]
fn does_not_decompress_frames_that_declare_another_length() {
    let decode = |file: File| Ktx2::parse(&file.encode()).unwrap().decode_level(0);
    let declaring = |length: usize| ::zstd::bulk::compress(&vec![0; length], 3).unwrap();
    for found in [255, 64 << 20] {
        let file = compressed(SupercompressionScheme::Zstandard, declaring(found), 256);
        assert_eq!(decode(file), Err(ReadError::LevelLength { level: 0, expected: 256, found: found as u64 }));
    }
    let parts = [declaring(100), declaring(156)].concat();
    assert!(decode(compressed(SupercompressionScheme::Zstandard, parts, 256)).is_ok());
    // One byte of zlib decompresses to at most 1032.
    let level = (zlib(&[0; 100]), 1 << 26);
    let file = File {
        levels: vec![level],
        scheme: Some(SupercompressionScheme::ZLIB),
        ..plain(Format::R8_UNORM, (8192, 8192), &[])
    };
    assert!(matches!(decode(file), Err(ReadError::Compression { what, .. }) if what.contains("at most")));
}

/// Overwrites the word of the header at `at` (KTX 2.0, section 3).
fn with_word(file: &[u8], at: usize, value: u32) -> Vec<u8> {
    let mut file = file.to_vec();
    file[at..at + 4].copy_from_slice(&value.to_le_bytes());
    file
}

#[test]
fn checks_sizes_before_allocating() {
    let file = compressed(SupercompressionScheme::Zstandard, zstd(&[0; 256]), 256).encode();
    let huge = with_word(&with_word(&file, 20, u32::MAX), 24, u32::MAX);
    let refused = Ktx2::parse(&huge).unwrap().decode_level(0);
    assert!(matches!(refused, Err(ReadError::TooLarge { images: 1, .. })), "{refused:?}");
    let refused = Ktx2::parse(&file).unwrap().with_max_texels(255).decode_level(0);
    assert!(matches!(refused, Err(ReadError::TooLarge { limit: 255, .. })));
    let layers = with_word(&file, 32, u32::MAX);
    let refused = Ktx2::parse(&layers).unwrap().level_bytes(0);
    assert!(matches!(refused, Err(ReadError::TooLarge { .. })));
}

#[test]
fn decodes_only_plain_2d_textures() {
    let file = plain(Format::R8_UNORM, (1, 1), &[&[7; 6]]).encode();
    for (at, value, kind) in
        [(24, 0, "a 1D texture"), (28, 1, "a 3D texture"), (32, 2, "an array"), (36, 6, "a cube map")]
    {
        let file = with_word(&file, at, value);
        let refused = Ktx2::parse(&file).unwrap().decode_level(0);
        assert_eq!(refused, Err(ReadError::NotPlain2d { kind }));
    }
    let cube = with_word(&file, 36, 6);
    assert_eq!(*Ktx2::parse(&cube).unwrap().level_bytes(0).unwrap(), [7; 6]);
}

#[test]
fn names_what_is_wrong_with_a_header() {
    let file = plain(Format::R8_UNORM, (4, 4), &[&[0; 16]]).encode();
    let parse = |file: &[u8]| Ktx2::parse(file).err();
    let malformed = |what| Some(ReadError::Malformed { what });
    assert_eq!(parse(&[]), Some(ReadError::Foreign { found: Foreign::Empty }));
    let pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n";
    assert_eq!(parse(pointer), Some(ReadError::Foreign { found: Foreign::LfsPointer }));
    assert_eq!(parse(&file[1..]), Some(ReadError::NotKtx2));
    assert_eq!(parse(&with_word(&file, 20, 0)), malformed("a width of 0"));
    assert_eq!(parse(&with_word(&file, 36, 0)), malformed("0 faces"));
    assert_eq!(parse(&with_word(&file, 36, 2)), malformed("neither 1 nor 6 faces"));
    let levels = parse(&with_word(&file, 40, 4));
    assert_eq!(levels, malformed("more levels than the size has"));
    // A block dimension of 255 would panic inside `ktx2` 0.5.
    let descriptor = u32::from_le_bytes(file[48..52].try_into().unwrap()) as usize;
    let block = parse(&with_word(&file, descriptor + 16, 0x0000_ff00));
    assert_eq!(block, malformed("a texel block of 256 texels"));
    for at in [48, 52, 56, 60] {
        let cut = parse(&with_word(&file, at, u32::MAX));
        let length = file.len() as u64;
        assert_eq!(cut, Some(ReadError::Truncated { length }), "{at}");
    }
}

/// Returns files whose payloads go through every decoder.
fn files() -> Vec<Vec<u8>> {
    let uastc = File {
        format: None,
        descriptor: descriptor(ColorModel::UASTC, &[3], 4, 16),
        ..plain(Format::R8_UNORM, (8, 4), &[&[0x5a; 32]])
    };
    let mut files: Vec<Vec<u8>> = [
        (Format::BC1_RGB_UNORM_BLOCK, 16),
        (Format::BC3_UNORM_BLOCK, 32),
        (Format::BC6H_SFLOAT_BLOCK, 32),
        (Format::BC7_UNORM_BLOCK, 32),
        (Format::R16G16_SFLOAT, 128),
    ]
    .map(|(format, length)| plain(format, (8, 4), &[&vec![0x3c; length]]).encode())
    .into();
    files.push(uastc.encode());
    files.push(ETC1S.to_vec());
    files.push(compressed(SupercompressionScheme::Zstandard, zstd(&[9; 256]), 256).encode());
    files.push(compressed(SupercompressionScheme::ZLIB, zlib(&[9; 256]), 256).encode());
    files
}

/// Calls every method that reads the file.
fn read_all(file: &[u8]) -> Result<(), ReadError> {
    let found = Ktx2::parse(file)?.with_max_texels(1 << 16);
    let _ = (found.format_name(), found.key_values().count());
    for level in 0..found.level_count() {
        let _ = found.level_bytes(level);
        found.decode_level(level)?;
    }
    Ok(())
}

#[test]
fn every_truncation_is_an_error() {
    for file in files() {
        for length in 0..file.len() {
            assert!(read_all(&file[..length]).is_err(), "{length} of {}", file.len());
        }
    }
}

#[test]
fn changed_bytes_do_not_panic() {
    let mut state = 7u64;
    let mut random = |below: usize| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as usize % below
    };
    for file in files() {
        for _ in 0..ROUNDS {
            let mut changed = file.clone();
            for _ in 0..=random(4) {
                let at = random(changed.len());
                changed[at] = [0, 0xff, random(256) as u8, changed[at] ^ 1 << random(8)][random(4)];
            }
            let _ = read_all(&changed);
        }
    }
}

const ROUNDS: usize = 1000;

#[test]
fn decodes_the_barn_lamp_if_the_test_materials_are_there() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/AnisotropyBarnLamp");
    for name in ["anisotropy", "normalbump", "occlusionroughnessmetal"] {
        let Ok(file) = std::fs::read(format!("{folder}/AnisotropyBarnLamp_{name}.ktx2")) else {
            crate::skip::skip(&format!("{folder} does not exist"));
            continue;
        };
        let found = Ktx2::parse(&file).unwrap();
        let full = found.level_size(0).0.max(found.level_size(0).1).ilog2() + 1;
        assert_eq!(found.format_name(), "R8G8B8_UNORM", "{name}");
        for level in 0..found.level_count() {
            let image = found.decode_level(level).unwrap();
            assert_eq!((image.width, image.height), found.level_size(level));
            assert_eq!(image.channels, 3);
        }
        assert!(found.level_count() <= full);
    }
}
