use ktx2::{Format, Header};

use super::*;
use crate::codec::PayloadFormat;
use crate::codec::uastc::Effort;
use crate::ktx2::{Ktx2Writer, StoredLevel};

/// Returns a KTX2 of one block, whose header `edit` changes.
fn ktx2(edit: impl FnOnce(&mut Header)) -> Vec<u8> {
    let format = PayloadFormat::UastcRgb;
    let level = StoredLevel::new(vec![0; 16], format, Effort::Fast).expect("memory");
    let file = Ktx2Writer { format, width: 4, height: 4, levels: vec![level], keys: &[] };
    let mut bytes = file.into_bytes().expect("memory");
    let mut header = Ktx2::parse(&bytes).expect("a KTX2").header();
    edit(&mut header);
    bytes[..Header::LENGTH].copy_from_slice(&header.as_bytes());
    bytes
}

#[test]
fn formats_that_change_bumps_are_named() {
    let webp = |kind: &[u8], payload: &[u8]| {
        let length = |bytes: usize| (bytes as u32).to_le_bytes();
        [b"RIFF", &length(payload.len() + 12)[..], b"WEBP", kind, &length(payload.len()), payload].concat()
    };
    // One texel each: a key frame with its two partitions, and five trivial Huffman codes.
    let lossy = b"\x30\x01\0\x9d\x01\x2a\x01\0\x01\0\x0e\xc0\xfe\x25\xa4\0\x03\x70\0\0\0\0";
    let lossless = b"\x2f\0\0\0\x10\x07\x10\x11\x11\x88\x88\xfe\x07\0";
    assert_eq!(lossy_format(&webp(b"VP8 ", lossy)), Some("a lossy WebP"));
    assert_eq!(lossy_format(&webp(b"VP8L", lossless)), None);
    assert_eq!(lossy_format(b"\xff\xd8\xff\xe0"), Some("a JPEG"));
    assert_eq!(lossy_format(b"\x89PNG\r\n\x1a\n"), None);
    assert_eq!(lossy_format(b"no image"), None);

    assert_eq!(lossy_format(&ktx2(|_| ())), None);
    let etc1s = ktx2(|header| header.supercompression_scheme = Some(SupercompressionScheme::BasisLZ));
    assert_eq!(lossy_format(&etc1s), Some("an ETC1S KTX2"));
    for (format, expected) in [
        (Format::BC1_RGB_UNORM_BLOCK, Some("a BC1, BC2 or BC3 KTX2")),
        (Format::BC3_UNORM_BLOCK, Some("a BC1, BC2 or BC3 KTX2")),
        (Format::BC5_UNORM_BLOCK, None),
        (Format::BC7_UNORM_BLOCK, None),
    ] {
        assert_eq!(lossy_format(&ktx2(|header| header.format = Some(format))), expected, "{format:?}");
    }
}
