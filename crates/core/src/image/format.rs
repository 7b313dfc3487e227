//! Detects image formats.

use std::fmt;

/// An image format that [`decode`](crate::decode::decode()) reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Portable Network Graphics.
    Png,
    /// JPEG, baseline or progressive.
    Jpeg,
    /// Tagged Image File Format, BigTIFF included.
    Tiff,
    /// Truevision TGA, which has no signature and is detected by the extension of the file.
    Tga,
    /// WebP, lossy or lossless.
    WebP,
    /// Radiance RGBE.
    Hdr,
    /// OpenEXR.
    Exr,
    /// KTX 2.
    Ktx2,
}

impl Format {
    /// Detects the format by the first bytes, or by the file's `extension` for a format without a signature (TGA). The
    /// extension has no dot and may be in upper or lower case. A signature takes precedence over the extension.
    pub fn detect(bytes: &[u8], extension: Option<&str>) -> Option<Format> {
        const SIGNATURES: [(&[u8], Format); 10] = [
            (b"\x89PNG\r\n\x1a\n", Format::Png),
            (b"\xff\xd8\xff", Format::Jpeg),
            (b"II*\0", Format::Tiff),
            (b"MM\0*", Format::Tiff),
            (b"II+\0", Format::Tiff),
            (b"MM\0+", Format::Tiff),
            (b"#?RADIANCE", Format::Hdr),
            (b"#?RGBE", Format::Hdr),
            (b"\x76\x2f\x31\x01", Format::Exr),
            (&ktx2::MAGIC, Format::Ktx2),
        ];
        let signed = SIGNATURES.iter().find(|(signature, _)| bytes.starts_with(signature)).map(|&(_, format)| format);
        let is_webp = bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP");
        let is_tga = || extension.is_some_and(|e| e.eq_ignore_ascii_case("tga"));
        signed.or(is_webp.then_some(Format::WebP)).or_else(|| is_tga().then_some(Format::Tga))
    }

    /// Returns the MIME type. IANA has not registered types of TGA and OpenEXR; theirs are those of the freedesktop.org
    /// database.
    pub fn mime_type(self) -> &'static str {
        match self {
            Format::Png => "image/png",
            Format::Jpeg => "image/jpeg",
            Format::Tiff => "image/tiff",
            Format::Tga => "image/x-tga",
            Format::WebP => "image/webp",
            Format::Hdr => "image/vnd.radiance",
            Format::Exr => "image/x-exr",
            Format::Ktx2 => "image/ktx2",
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Format::Png => "PNG",
            Format::Jpeg => "JPEG",
            Format::Tiff => "TIFF",
            Format::Tga => "TGA",
            Format::WebP => "WebP",
            Format::Hdr => "Radiance HDR",
            Format::Exr => "OpenEXR",
            Format::Ktx2 => "KTX2",
        })
    }
}
