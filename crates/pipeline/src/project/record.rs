//! What baked documents record of their making.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use crate::bake::DocumentProvenance;
use crate::gltf::document::Document;
use crate::gltf::json::Json;
use crate::input_file::check_file;

/// The first bytes of a .glb file.
pub const GLB_MAGIC: &[u8] = b"glTF";

/// Returns what the document at `path` records of its making; `None` where the file cannot be read or records nothing.
/// From a .glb file only the JSON is read.
pub fn recorded(path: &Path) -> Option<DocumentProvenance> {
    let json = json(path).ok()?;
    // Most documents are not outputs of Roughcast, and parsing them would cost more than reading them.
    if !std::str::from_utf8(&json).is_ok_and(|text| text.contains("\"roughcast\"")) {
        return None;
    }
    DocumentProvenance::read(&Document::gltf(Json::parse(&json).ok()?))
}

/// Returns whether an earlier bake wrote the document at `path`, by what the document records.
pub fn is_baked(path: &Path) -> bool {
    recorded(path).is_some()
}

/// Returns the JSON of the document at `path`.
fn json(path: &Path) -> io::Result<Vec<u8>> {
    /// Bytes of the file header and of the header of the first chunk, which is the JSON.
    const HEADER: u64 = 20;
    let length = check_file(path)?;
    let mut file = File::open(path)?;
    let mut bytes = Vec::new();
    file.by_ref().take(HEADER).read_to_end(&mut bytes)?;
    let chunk = bytes.get(12..16).and_then(<[u8]>::first_chunk).map(|length| u32::from_le_bytes(*length));
    let rest = match chunk {
        Some(chunk) if bytes.starts_with(GLB_MAGIC) => {
            bytes.clear();
            u64::from(chunk)
        }
        _ => length,
    };
    file.take(rest).read_to_end(&mut bytes)?;
    Ok(bytes)
}
