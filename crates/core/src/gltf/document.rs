//! glTF assets in memory, text or binary. Parts that were not edited are written back byte for byte.

mod error;
mod glb;
mod kind;
#[cfg(test)]
mod tests;

use std::ops::Range;

use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use super::json::{Json, JsonError};
use glb::{Chunks, MAGIC};

pub use error::DocumentError;
pub use kind::check_version;

/// The two container formats of a glTF asset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Container {
    /// JSON text, `.gltf`.
    Gltf,
    /// The binary container, `.glb` (glTF 2.0 section 4.4).
    Glb,
}

impl Container {
    /// Returns the extension of file names, without its dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Gltf => "gltf",
            Self::Glb => "glb",
        }
    }
}

/// A `.gltf` or `.glb` file: its JSON, open to edits, and the chunks of the binary container.
#[derive(Debug, Clone)]
pub struct Document {
    json: Json,
    /// The chunks of a GLB after its JSON.
    chunks: Option<Chunks>,
}

/// The length of a buffer, and where its bytes are.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Buffer {
    uri: Option<String>,
    byte_length: usize,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct BufferView {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
}

impl Document {
    /// Reads a file of either container. The first four bytes decide which.
    ///
    /// # Errors
    /// [`DocumentError::Json`] if the JSON is not well formed, [`DocumentError::Image`], [`DocumentError::NotGltf`] and
    /// [`DocumentError::Foreign`] for other files, and for a GLB the errors of its version, lengths and chunks. The
    /// meaning of the JSON is not checked: see [`check_version`].
    pub fn parse(bytes: &[u8]) -> Result<Document, DocumentError> {
        if !bytes.starts_with(MAGIC) {
            kind::check_text(bytes)?;
            return Ok(Document::gltf(Json::parse(bytes)?));
        }
        let (json, chunks) = Chunks::parse(bytes)?;
        Ok(Document { json: Json::parse(json)?, chunks: Some(chunks) })
    }

    /// Returns a `.gltf` document with this JSON.
    pub fn gltf(json: Json) -> Document {
        Document { json, chunks: None }
    }

    /// Returns a `.glb` document with this JSON and, for a buffer 0 without a `uri`, its bytes.
    pub fn glb(json: Json, bin: Option<Vec<u8>>) -> Document {
        Document { json, chunks: Some(Chunks::new(bin)) }
    }

    /// Returns the container that [`to_bytes`](Self::to_bytes) writes.
    pub fn container(&self) -> Container {
        if self.chunks.is_some() { Container::Glb } else { Container::Gltf }
    }

    /// Returns the JSON of the asset.
    pub fn json(&self) -> &Json {
        &self.json
    }

    /// Returns the JSON of the asset for edits.
    pub fn json_mut(&mut self) -> &mut Json {
        &mut self.json
    }

    /// Returns the BIN chunk of a GLB with its padding: up to 3 bytes more than buffer 0 declares. The chunk may be
    /// unused: see [`buffer_0`](Self::buffer_0).
    pub fn bin(&self) -> Option<&[u8]> {
        self.chunks.as_ref()?.bin()
    }

    /// Returns the BIN chunk if it is buffer 0. A first buffer with a `uri` is stored elsewhere, and without a buffer
    /// the chunk is unused (glTF 2.0, section 4.4.3.3).
    pub fn buffer_0(&self) -> Option<&[u8]> {
        let buffer = self.json.value("/buffers/0").ok()??;
        self.bin().filter(|_| buffer.get("uri").is_none_or(Value::is_null))
    }

    /// Replaces the BIN chunk of a GLB, padded to a multiple of 4, or removes it. Other chunks stay.
    ///
    /// # Errors
    /// [`DocumentError::NotGlb`].
    pub fn set_bin(&mut self, bin: Option<&[u8]>) -> Result<(), DocumentError> {
        self.chunks.as_mut().ok_or(DocumentError::NotGlb)?.set_bin(bin);
        Ok(())
    }

    /// Returns the bytes of the file. Without edits, these are the bytes that were read. In a GLB, an edit of the JSON
    /// changes only the JSON chunk and the lengths.
    ///
    /// # Errors
    /// [`DocumentError::TooLarge`] for a GLB beyond 4 GiB.
    pub fn to_bytes(&self) -> Result<Vec<u8>, DocumentError> {
        match &self.chunks {
            None => Ok(self.json.to_bytes()),
            Some(chunks) => chunks.write(self.json.to_bytes()),
        }
    }

    /// Appends `data` to the BIN chunk at a multiple of 4, and sets the `byteLength` of buffer 0. The chunk and the
    /// buffer are created if the GLB has no buffer yet. Returns the `byteOffset` and `byteLength` for a buffer view of
    /// the data.
    ///
    /// # Errors
    /// [`DocumentError::NotGlb`], [`DocumentError::TooLarge`], and [`DocumentError::NoBinBuffer`] if buffer 0 is stored
    /// elsewhere. The document is then unchanged.
    pub fn append_bin(&mut self, data: &[u8]) -> Result<(usize, usize), DocumentError> {
        let chunks = self.chunks.as_mut().ok_or(DocumentError::NotGlb)?;
        let buffer: Option<Buffer> = self.json.read("/buffers/0")?;
        let is_bin = match &buffer {
            Some(buffer) => {
                let has_bytes = chunks.bin().is_some_and(|bin| buffer.byte_length <= bin.len());
                buffer.uri.is_none() && has_bytes
            }
            None => chunks.bin().is_none(),
        };
        if !is_bin {
            return Err(DocumentError::NoBinBuffer);
        }
        let offset = chunks.bin().unwrap_or_default().len();
        let length = glb::checked_length(offset, data.len())?;
        match buffer {
            Some(_) => self.json.set("/buffers/0/byteLength", &length)?,
            None => {
                self.json.push("/buffers", &json!({ "byteLength": length }))?;
            }
        }
        chunks.append_bin(data);
        Ok((offset, data.len()))
    }

    /// Returns the buffer of buffer view `index`, and the range of bytes that the view covers. The range is inside the
    /// `byteLength` that the buffer declares.
    ///
    /// # Errors
    /// [`DocumentError::Missing`] for an index that does not exist, [`DocumentError::ViewOutside`] for a range outside
    /// the buffer, and [`DocumentError::Json`] for fields of a wrong type.
    pub fn buffer_view(&self, index: usize) -> Result<(usize, Range<usize>), DocumentError> {
        let pointer = format!("/bufferViews/{index}");
        let view: BufferView = self.json.read(&pointer)?.ok_or(DocumentError::Missing { pointer })?;
        let pointer = format!("/buffers/{}", view.buffer);
        let buffer: Buffer = self.json.read(&pointer)?.ok_or(DocumentError::Missing { pointer })?;
        range(index, &view, &buffer)
    }
}

/// Returns [`Document::buffer_view`] of a document whose JSON is `root`, which need not be read again for each view.
///
/// # Errors
/// The errors of [`Document::buffer_view`].
pub fn view_range(root: &Value, index: usize) -> Result<(usize, Range<usize>), DocumentError> {
    let view: BufferView = element(root, "bufferViews", index)?;
    let buffer: Buffer = element(root, "buffers", view.buffer)?;
    range(index, &view, &buffer)
}

fn element<T: DeserializeOwned>(root: &Value, array: &str, index: usize) -> Result<T, DocumentError> {
    let pointer = || format!("/{array}/{index}");
    let element = root.get(array).and_then(|array| array.get(index));
    let element = element.ok_or_else(|| DocumentError::Missing { pointer: pointer() })?;
    T::deserialize(element).map_err(|source| JsonError::Read { pointer: pointer(), source }.into())
}

fn range(index: usize, view: &BufferView, buffer: &Buffer) -> Result<(usize, Range<usize>), DocumentError> {
    match view.byte_offset.checked_add(view.byte_length) {
        Some(end) if end <= buffer.byte_length => Ok((view.buffer, view.byte_offset..end)),
        _ => Err(DocumentError::ViewOutside {
            view: index,
            offset: view.byte_offset,
            length: view.byte_length,
            buffer: view.buffer,
            buffer_length: buffer.byte_length,
        }),
    }
}
