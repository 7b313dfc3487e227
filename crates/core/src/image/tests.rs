//! Cut, changed and lying files: an error or the right picture, never another one or a panic.

use ::exr::prelude::{Blocks, Compression, Encoding, LineOrder};
use ::image::ExtendedColorType;
use ::tiff::encoder::colortype;

use crate::image::decode::DecodeOptions;
use crate::image::decode::decode_raster as decode;
use crate::image::error::DecodeError;
use crate::image::format::FileFormat;
use crate::image::test_files;
use crate::image::test_files::{Png, exr, halves, value, values};

/// Returns a small file in every format, with its name.
fn files() -> Vec<(&'static str, Vec<u8>)> {
    let texels = [[0.5, 2.0, 0.25]; 24];
    let interlaced =
        Png { size: (5, 7), color: 3, depth: 4, interlaced: true, chunks: &[(b"PLTE", &[7; 48]), (b"tRNS", &[1, 2])] };
    let exr = |compression, blocks| {
        let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
        let channels = vec![("G", halves(6, 5, 1)), ("R", halves(6, 5, 0))];
        let depth = vec![("Z", halves(6, 5, 2))];
        exr((6, 5), encoding, vec![(Some("a"), channels), (Some("b"), depth)])
    };
    vec![
        ("png", test_files::png(5, 4)),
        ("png", interlaced.encode(|x, y, c| u16::from(value(x, y, c)) & 15)),
        ("jpg", test_files::jpeg(&[128, 100, 255], false)),
        ("jpg", test_files::jpeg(&[128, 100, 255], true)),
        ("tif", test_files::tiff::<colortype::RGB8>(5, 4, &values(5, 4, 3))),
        ("tif", test_files::tiff::<colortype::Gray32Float>(5, 4, &[0.5; 20])),
        ("tga", test_files::tga(5, 4)),
        ("webp", test_files::webp(5, 4, ExtendedColorType::Rgb8)),
        ("hdr", test_files::hdr(&texels, 8, 3)),
        ("exr", exr(Compression::Uncompressed, Blocks::ScanLines)),
        ("exr", exr(Compression::ZIP16, Blocks::Tiles((4, 4).into()))),
        ("exr", exr(Compression::PIZ, Blocks::ScanLines)),
        ("exr", exr(Compression::PXR24, Blocks::ScanLines)),
        ("exr", exr(Compression::B44, Blocks::ScanLines)),
        ("exr", exr(Compression::DWAA(None), Blocks::ScanLines)),
    ]
}

/// Few enough texels that a lying header cannot make a test slow.
fn options(extension: &str) -> DecodeOptions {
    DecodeOptions { max_pixels: 1 << 16, layer: None, extension: Some(extension.into()) }
}

#[test]
fn every_truncation_is_an_error_or_the_same_picture() {
    for (name, file) in files() {
        let options = options(name);
        let whole = decode(&file, &options).unwrap();
        let mut refused = 0;
        for length in 0..file.len() {
            match decode(&file[..length], &options) {
                Ok(found) => assert_eq!(found, whole, "{name} cut to {length}"),
                Err(_) => refused += 1,
            }
        }
        // A trailer, such as a PNG's end chunk or a TGA's footer, may go missing; half a file not.
        assert!(refused > file.len() / 2, "{name}: {refused} of {}", file.len());
    }
}

#[test]
fn bytes_after_the_end_change_nothing() {
    for (name, mut file) in files() {
        let options = options(name);
        let whole = decode(&file, &options);
        file.extend([0xa5; 100]);
        assert_eq!(decode(&file, &options), whole, "{name}");
    }
}

#[test]
fn changed_bytes_never_panic() {
    let mut state = 1u64;
    let mut random = |below: usize| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as usize % below
    };
    for (name, file) in files() {
        for _ in 0..ROUNDS {
            let mut changed = file.clone();
            for _ in 0..=random(3) {
                let at = random(changed.len());
                match random(6) {
                    0 => changed[at] ^= 1 << random(8),
                    1 => changed[at] = random(256) as u8,
                    2 => drop(changed.remove(at)),
                    3 => changed.insert(at, random(256) as u8),
                    // The extremes of a length or a side, in both byte orders.
                    order => {
                        let word = [0, 1, 0xffff, 0x1_0000, 0x7fff_ffff, 0x8000_0000, u32::MAX][random(7)];
                        let word = if order == 4 { word.to_le_bytes() } else { word.to_be_bytes() };
                        changed.iter_mut().skip(at).zip(word).for_each(|(to, from)| *to = from);
                    }
                }
            }
            let _ = decode(&changed, &options(name));
        }
    }
}

const ROUNDS: usize = 300;

#[test]
fn dimensions_are_bounded_before_anything_is_allocated() {
    let mut options = options("tga");
    options.max_pixels = 19;
    for (name, file) in files() {
        let found = decode(&file, &options);
        assert!(matches!(found, Err(DecodeError::TooLarge { limit: 19, .. })), "{name}: {found:?}");
    }
    // A small PNG that claims 2^31 - 1 texels a side.
    let png = Png { size: (1, 1), color: 0, depth: 8, interlaced: false, chunks: &[] };
    let mut file = png.encode(|_, _, _| 0);
    for at in [16, 20] {
        file[at..at + 4].copy_from_slice(&0x7fff_ffffu32.to_be_bytes());
    }
    let mut checksum = flate2::Crc::new();
    checksum.update(&file[12..29]);
    file[29..33].copy_from_slice(&checksum.sum().to_be_bytes());
    let found = decode(&file, &DecodeOptions::default());
    assert!(matches!(found, Err(DecodeError::TooLarge { .. })), "{found:?}");
}

/// 74 bytes that claim 16384 x 16384 texels of 64 bits.
#[test]
fn a_png_too_short_for_its_size_is_refused_before_anything_is_allocated() {
    for (color, depth, side) in [(6u8, 16u8, 16384u32), (0, 1, 16384), (3, 8, 4000)] {
        let png = Png { size: (1, 1), color: 0, depth: 8, interlaced: false, chunks: &[] };
        let mut file = png.encode(|_, _, _| 0);
        for at in [16, 20] {
            file[at..at + 4].copy_from_slice(&side.to_be_bytes());
        }
        file[24..26].copy_from_slice(&[depth, color]);
        let found = decode(&file, &DecodeOptions::default());
        let is_short = |what: &str| what.contains("cannot hold");
        assert!(matches!(&found, Err(DecodeError::Truncated { what, .. }) if is_short(what)), "{found:?}");
    }
}

/// The best that deflate does is allowed for.
#[test]
fn a_large_png_of_one_colour_is_read() {
    let png = Png { size: (3000, 3000), color: 6, depth: 16, interlaced: false, chunks: &[] };
    let file = png.encode(|_, _, _| 0x5555);
    assert!(file.len() < 100_000);
    assert!(decode(&file, &DecodeOptions::default()).is_ok());
}

#[test]
fn no_texels_are_refused() {
    let png = Png { size: (0, 3), color: 0, depth: 8, interlaced: false, chunks: &[] };
    let found = decode(&png.encode(|_, _, _| 0), &DecodeOptions::default());
    assert!(matches!(found, Err(DecodeError::Malformed { .. })), "{found:?}");
    let mut tga = test_files::tga(5, 4);
    tga[12..14].fill(0);
    let found = decode(&tga, &options("tga"));
    assert!(matches!(found, Err(DecodeError::Malformed { .. })), "{found:?}");
}

#[test]
fn a_cut_png_is_called_truncated() {
    let file = test_files::png(5, 4);
    let found = decode(&file[..60], &DecodeOptions::default());
    assert!(matches!(found, Err(DecodeError::Truncated { format: FileFormat::Png, .. })), "{found:?}");
}

#[test]
fn unknown_and_empty_files_are_named_so() {
    for bytes in [&b"RIFF"[..], b"hello, world"] {
        let found = decode(bytes, &DecodeOptions::default());
        let start = bytes[..bytes.len().min(8)].to_vec();
        assert_eq!(found, Err(DecodeError::UnknownFormat { start }));
    }
    for bytes in [&b"glTF\x02\0\0\0"[..], b"\n {\"asset\": {}}"] {
        assert_eq!(decode(bytes, &DecodeOptions::default()), Err(DecodeError::Asset));
    }
    let message = decode(b"", &options("tga")).unwrap_err().to_string();
    assert!(message.ends_with("found an empty file; copy or export it again"), "{message}");
}

/// With overflow checks, `exr` 1.74 panics on many a changed byte in a B44 block.
#[test]
fn a_panic_of_a_decoder_is_an_error() {
    let encoding =
        Encoding { compression: Compression::B44, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    let file = exr((6, 5), encoding, vec![(None, vec![("Y", halves(6, 5, 0))])]);
    let whole = decode(&file, &options("exr")).unwrap();
    for at in 0..file.len() {
        let mut changed = file.clone();
        changed[at] ^= 0x55;
        if let Ok(found) = decode(&changed, &options("exr")) {
            assert_eq!(found.channels, whole.channels);
        }
    }
}
