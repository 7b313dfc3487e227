//! The facts of a KTX2 file.

use ktx2::SupercompressionScheme;
use ktx2::dfd::{Basic, ChannelTypeQualifiers, DataFormatFlags};
use serde::Serialize;

use crate::ktx2::{Ktx2, PROVENANCE_KEY, Provenance, ReadError, provenance};
use crate::text::name_of;

/// A KTX2 file.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct TextureFacts {
    /// Columns of level 0.
    pub width: u32,
    /// Rows of level 0.
    pub height: u32,
    /// Slices; 0 for 2D.
    pub depth: u32,
    /// Layers; 0 when not an array.
    pub layers: u32,
    /// 6 for a cube, else 1.
    pub faces: u32,
    /// Name of the Vulkan format; `UNDEFINED` for Basis Universal.
    pub format: String,
    /// `none`, `zstd`, `zlib`, `BasisLZ` or a number.
    pub supercompression: String,
    /// Level 0 first.
    pub levels: Vec<LevelFacts>,
    /// The basic data format descriptor, where there is one.
    pub descriptor: Option<DescriptorFacts>,
    /// Key/value data without the provenance, in the file's order.
    pub keys: Vec<KeyFacts>,
    /// The provenance, if the texture has one.
    pub provenance: Option<Provenance>,
}

/// A level.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct LevelFacts {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// First byte in the file.
    pub offset: u64,
    /// Bytes in the file.
    pub stored_bytes: u64,
    /// Bytes after decompression; 0 for BasisLZ.
    pub uncompressed_bytes: u64,
}

/// The basic data format descriptor.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct DescriptorFacts {
    /// Colour model, such as `UASTC`.
    pub model: String,
    /// Colour primaries.
    pub primaries: String,
    /// Transfer function.
    pub transfer: String,
    /// Whether alpha is premultiplied.
    pub alpha_premultiplied: bool,
    /// Columns and rows of a texel block.
    pub block: [u8; 2],
    /// Bytes of a block; 0 where the writer left it out.
    pub block_bytes: u8,
    /// Its samples.
    pub samples: Vec<SampleFacts>,
}

/// A sample of the descriptor.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct SampleFacts {
    /// Channel number, whose meaning depends on the colour model.
    pub channel: u8,
    /// First bit.
    pub bit_offset: u16,
    /// Number of bits.
    pub bits: u8,
    /// Whether it is signed.
    pub signed: bool,
    /// Whether it is a float.
    pub float: bool,
}

/// An entry of the key/value data.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KeyFacts {
    /// The key.
    pub key: String,
    /// Its value as text, or `<n> bytes`.
    pub value: String,
}

/// Reads the facts of a KTX2 file.
///
/// # Errors
/// [`ReadError`] if the file is not a valid KTX2.
pub fn inspect_texture(bytes: &[u8]) -> Result<TextureFacts, ReadError> {
    let file = Ktx2::parse(bytes)?;
    let header = file.header();
    let levels = (0..).zip(file.levels()).map(|(index, level)| {
        let (width, height) = file.level_size(index);
        let (offset, stored_bytes, uncompressed_bytes) = (level.offset, level.length, level.uncompressed_length);
        LevelFacts { width, height, offset, stored_bytes, uncompressed_bytes }
    });
    let provenance = provenance(&file);
    let keys = file.key_values().filter(|(key, _)| provenance.is_none() || *key != PROVENANCE_KEY);
    Ok(TextureFacts {
        width: header.pixel_width,
        height: header.pixel_height,
        depth: header.pixel_depth,
        layers: header.layer_count,
        faces: header.face_count,
        format: file.format_name(),
        supercompression: scheme_name(header.supercompression_scheme),
        levels: levels.collect(),
        descriptor: file.descriptor().map(descriptor),
        keys: keys.map(|(key, value)| KeyFacts { key: key.to_owned(), value: text(value) }).collect(),
        provenance,
    })
}

fn scheme_name(scheme: Option<SupercompressionScheme>) -> String {
    match scheme {
        None => "none".to_owned(),
        Some(SupercompressionScheme::Zstandard) => "zstd".to_owned(),
        Some(SupercompressionScheme::ZLIB) => "zlib".to_owned(),
        Some(other) => format!("{other:?}"),
    }
}

fn descriptor(basic: &Basic) -> DescriptorFacts {
    let [width, height, ..] = basic.texel_block_dimensions;
    let samples = basic.sample_information.iter().map(|sample| SampleFacts {
        channel: sample.channel_type,
        bit_offset: sample.bit_offset,
        bits: sample.bit_length.get(),
        signed: sample.channel_type_qualifiers.contains(ChannelTypeQualifiers::SIGNED),
        float: sample.channel_type_qualifiers.contains(ChannelTypeQualifiers::FLOAT),
    });
    DescriptorFacts {
        model: name_of(basic.color_model.as_ref()),
        primaries: name_of(basic.color_primaries.as_ref()),
        transfer: name_of(basic.transfer_function.as_ref()),
        alpha_premultiplied: basic.flags.contains(DataFormatFlags::ALPHA_PREMULTIPLIED),
        block: [width.get(), height.get()],
        block_bytes: basic.bytes_planes[0],
        samples: samples.collect(),
    }
}

/// Length limit of a printed value, in characters.
const MAX_CHARACTERS: usize = 1000;

fn text(value: &[u8]) -> String {
    match std::str::from_utf8(value.strip_suffix(b"\0").unwrap_or(value)) {
        Ok(text) if !text.contains(char::is_control) => match text.char_indices().nth(MAX_CHARACTERS) {
            Some((end, _)) => format!("{}...", &text[..end]),
            None => text.to_owned(),
        },
        _ => format!("{} bytes", value.len()),
    }
}
