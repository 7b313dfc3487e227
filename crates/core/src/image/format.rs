//! Detects image formats.

use std::fmt;

/// An image format that [`decode`](crate::decode::decode()) reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileFormat {
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

impl FileFormat {
    /// Detects the format by the first bytes, or by the file's `extension` for a format without a signature (TGA). The
    /// extension has no dot and may be in upper or lower case. A signature takes precedence over the extension.
    pub fn detect(bytes: &[u8], extension: Option<&str>) -> Option<FileFormat> {
        const SIGNATURES: [(&[u8], FileFormat); 10] = [
            (b"\x89PNG\r\n\x1a\n", FileFormat::Png),
            (b"\xff\xd8\xff", FileFormat::Jpeg),
            (b"II*\0", FileFormat::Tiff),
            (b"MM\0*", FileFormat::Tiff),
            (b"II+\0", FileFormat::Tiff),
            (b"MM\0+", FileFormat::Tiff),
            (b"#?RADIANCE", FileFormat::Hdr),
            (b"#?RGBE", FileFormat::Hdr),
            (b"\x76\x2f\x31\x01", FileFormat::Exr),
            (&ktx2::MAGIC, FileFormat::Ktx2),
        ];
        let signed = SIGNATURES.iter().find(|(signature, _)| bytes.starts_with(signature)).map(|&(_, format)| format);
        let is_webp = bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP");
        let is_tga = || extension.is_some_and(|e| e.eq_ignore_ascii_case("tga"));
        signed.or(is_webp.then_some(FileFormat::WebP)).or_else(|| is_tga().then_some(FileFormat::Tga))
    }
}

impl fmt::Display for FileFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            FileFormat::Png => "PNG",
            FileFormat::Jpeg => "JPEG",
            FileFormat::Tiff => "TIFF",
            FileFormat::Tga => "TGA",
            FileFormat::WebP => "WebP",
            FileFormat::Hdr => "Radiance HDR",
            FileFormat::Exr => "OpenEXR",
            FileFormat::Ktx2 => "KTX2",
        })
    }
}
