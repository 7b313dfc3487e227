//! The table of image formats, and their detection.

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

/// The facts of a format.
struct Row {
    format: FileFormat,
    /// The name in messages about a file.
    name: &'static str,
    /// The name in lists of formats.
    short_name: &'static str,
    /// The first bytes of its files. A format without a signature is detected by the extension of the file.
    signatures: &'static [Signature],
    /// Extensions of its files, in lower case.
    extensions: &'static [&'static str],
    /// The MIME type. IANA has not registered types of TGA and OpenEXR; theirs are those of the freedesktop.org
    /// database.
    mime_type: &'static str,
    /// Whether glTF or one of its extensions names the format for images of documents.
    is_in_gltf: bool,
    /// Whether images of two channels hold red and green. In other formats they hold grey and alpha.
    has_red_and_green: bool,
}

/// Bytes by which a format is detected.
struct Signature {
    start: &'static [u8],
    /// Bytes from the ninth byte on.
    at_8: &'static [u8],
}

const fn start(start: &'static [u8]) -> Signature {
    Signature { start, at_8: b"" }
}

/// All formats.
static FORMATS: [Row; 8] = [
    Row {
        format: FileFormat::Png,
        name: "PNG",
        short_name: "PNG",
        signatures: &[start(b"\x89PNG\r\n\x1a\n")],
        extensions: &["png"],
        mime_type: "image/png",
        is_in_gltf: true,
        has_red_and_green: false,
    },
    Row {
        format: FileFormat::Jpeg,
        name: "JPEG",
        short_name: "JPEG",
        signatures: &[start(b"\xff\xd8\xff")],
        extensions: &["jpg", "jpeg"],
        mime_type: "image/jpeg",
        is_in_gltf: true,
        has_red_and_green: false,
    },
    Row {
        format: FileFormat::Tiff,
        name: "TIFF",
        short_name: "TIFF",
        signatures: &[start(b"II*\0"), start(b"MM\0*"), start(b"II+\0"), start(b"MM\0+")],
        extensions: &["tif", "tiff"],
        mime_type: "image/tiff",
        is_in_gltf: false,
        has_red_and_green: false,
    },
    Row {
        format: FileFormat::Tga,
        name: "TGA",
        short_name: "TGA",
        signatures: &[],
        extensions: &["tga"],
        mime_type: "image/x-tga",
        is_in_gltf: false,
        has_red_and_green: false,
    },
    Row {
        format: FileFormat::WebP,
        name: "WebP",
        short_name: "WebP",
        signatures: &[Signature { start: b"RIFF", at_8: b"WEBP" }],
        extensions: &["webp"],
        mime_type: "image/webp",
        is_in_gltf: true,
        has_red_and_green: false,
    },
    Row {
        format: FileFormat::Hdr,
        name: "Radiance HDR",
        short_name: "HDR",
        signatures: &[start(b"#?RADIANCE"), start(b"#?RGBE")],
        extensions: &["hdr"],
        mime_type: "image/vnd.radiance",
        is_in_gltf: false,
        has_red_and_green: false,
    },
    Row {
        format: FileFormat::Exr,
        name: "OpenEXR",
        short_name: "EXR",
        signatures: &[start(b"\x76\x2f\x31\x01")],
        extensions: &["exr"],
        mime_type: "image/x-exr",
        is_in_gltf: false,
        has_red_and_green: true,
    },
    Row {
        format: FileFormat::Ktx2,
        name: "KTX2",
        short_name: "KTX2",
        signatures: &[start(&ktx2::MAGIC)],
        extensions: &["ktx2"],
        mime_type: "image/ktx2",
        is_in_gltf: true,
        has_red_and_green: true,
    },
];

impl Signature {
    fn matches(&self, bytes: &[u8]) -> bool {
        bytes.starts_with(self.start) && bytes.get(8..).unwrap_or_default().starts_with(self.at_8)
    }
}

impl Row {
    fn has_extension(&self, extension: &str) -> bool {
        self.extensions.iter().any(|known| known.eq_ignore_ascii_case(extension))
    }
}

impl FileFormat {
    /// Detects the format by the first bytes, or by the file's `extension` for a format without a signature (TGA). The
    /// extension has no dot and may be in upper or lower case. A signature takes precedence over the extension.
    pub fn detect(bytes: &[u8], extension: Option<&str>) -> Option<FileFormat> {
        let signed = FORMATS.iter().find(|row| row.signatures.iter().any(|signature| signature.matches(bytes)));
        let is_named = |row: &&Row| row.signatures.is_empty() && extension.is_some_and(|e| row.has_extension(e));
        signed.or_else(|| FORMATS.iter().find(is_named)).map(|row| row.format)
    }

    /// Returns whether `extension` is one of an image file, in upper or lower case.
    pub fn is_extension(extension: &str) -> bool {
        FORMATS.iter().any(|row| row.has_extension(extension))
    }

    /// Returns the MIME type.
    pub fn mime_type(self) -> &'static str {
        self.row().mime_type
    }

    /// Returns whether glTF or one of its extensions names the format for images of documents.
    pub fn is_in_gltf(self) -> bool {
        self.row().is_in_gltf
    }

    /// Returns the short names of all formats.
    pub fn short_names() -> impl Iterator<Item = &'static str> {
        FORMATS.iter().map(|row| row.short_name)
    }

    /// Returns whether images of two channels hold red and green. In other formats they hold grey and alpha.
    pub fn has_red_and_green(self) -> bool {
        self.row().has_red_and_green
    }

    fn row(self) -> &'static Row {
        // Only formats with a row are detected.
        FORMATS.iter().find(|row| row.format == self).unwrap_or(&FORMATS[0])
    }
}

/// Returns the short names of all formats with a signature: "PNG, JPEG or KTX2".
pub(super) fn signed_formats() -> String {
    let names: Vec<&str> = FORMATS.iter().filter(|row| !row.signatures.is_empty()).map(|row| row.short_name).collect();
    match names.as_slice() {
        [names @ .., last] if !names.is_empty() => format!("{} or {last}", names.join(", ")),
        names => names.concat(),
    }
}

/// Returns the formats without a signature, each with its extension: ", or a TGA with the extension .tga".
pub(super) fn unsigned_formats() -> String {
    let unsigned = FORMATS.iter().filter(|row| row.signatures.is_empty());
    let named = unsigned.flat_map(|row| Some((row.short_name, row.extensions.first()?)));
    named.map(|(name, extension)| format!(", or a {name} with the extension .{extension}")).collect()
}

impl fmt::Display for FileFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.row().name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_signature_and_every_extension_detects_its_format() {
        for row in &FORMATS {
            for signature in row.signatures {
                let mut bytes = signature.start.to_vec();
                if !signature.at_8.is_empty() {
                    bytes.resize(8, 0);
                    bytes.extend(signature.at_8);
                }
                assert_eq!(FileFormat::detect(&bytes, Some("tga")), Some(row.format));
            }
            for extension in row.extensions {
                let is_unsigned = row.signatures.is_empty();
                let extension = extension.to_uppercase();
                assert_eq!(FileFormat::detect(b"", Some(&extension)), is_unsigned.then_some(row.format));
                assert!(FileFormat::is_extension(&extension));
            }
        }
        assert_eq!(FileFormat::detect(b"RIFF....WAVE", None), None);
        assert!(!FileFormat::is_extension("gltf"));
    }

    #[test]
    fn lists_name_every_format_once() {
        assert_eq!(signed_formats(), "PNG, JPEG, TIFF, WebP, HDR, EXR or KTX2");
        assert_eq!(unsigned_formats(), ", or a TGA with the extension .tga");
    }
}
