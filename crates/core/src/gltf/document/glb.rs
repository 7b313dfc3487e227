//! The binary container (glTF 2.0 section 4.4): a header of 12 bytes, then chunks of a length, a type and data. The
//! `binary` module of crate `gltf` 1.4.1 is not used, because it refuses or drops unknown chunks and underflows on a
//! header that declares fewer than 12 bytes.

use super::DocumentError;

pub(super) const MAGIC: &[u8] = b"glTF";
const VERSION: u32 = 2;
const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;
const JSON: [u8; 4] = *b"JSON";
const BIN: [u8; 4] = *b"BIN\0";

/// The chunks after the JSON chunk.
#[derive(Debug, Clone)]
pub(super) struct Chunks {
    /// Chunks of any type, in the order of the file. If there is a BIN chunk, it is the first.
    chunks: Vec<Chunk>,
    /// Zeros after the length that the header declares, from a writer that pads files.
    trailing: Vec<u8>,
}

#[derive(Debug, Clone)]
struct Chunk {
    kind: [u8; 4],
    /// The data with its padding: a multiple of 4 bytes.
    data: Vec<u8>,
}

impl Chunks {
    pub fn new(bin: Option<Vec<u8>>) -> Chunks {
        let mut chunks = Chunks { chunks: Vec::new(), trailing: Vec::new() };
        if let Some(bin) = bin {
            chunks.append_bin(&bin);
        }
        chunks
    }

    /// Splits a file that begins with [`MAGIC`] into the text of its JSON chunk and the other chunks.
    pub fn parse(bytes: &[u8]) -> Result<(&[u8], Chunks), DocumentError> {
        let truncated = |needed| DocumentError::Truncated { needed, found: bytes.len() };
        let version = word(bytes, 4).ok_or(truncated(HEADER))?;
        if version != VERSION {
            return Err(DocumentError::Version { found: version });
        }
        let declared = word(bytes, 8).ok_or(truncated(HEADER))? as usize;
        let (body, trailing) = bytes.split_at_checked(declared).ok_or(truncated(declared))?;
        if trailing.iter().any(|&byte| byte != 0) {
            return Err(DocumentError::Length { declared, found: bytes.len() });
        }
        let mut chunks = Vec::new();
        let mut at = HEADER;
        while at < body.len() {
            let (kind, data) = chunk(body, at)?;
            at += CHUNK_HEADER + data.len();
            chunks.push((kind, data));
        }
        let Some((&(JSON, json), rest)) = chunks.split_first() else {
            let found = chunks.first().map(|(kind, _)| kind.escape_ascii().to_string());
            return Err(DocumentError::NoJsonChunk { found: found.unwrap_or_else(|| "nothing".to_owned()) });
        };
        let chunks = rest.iter().map(|&(kind, data)| Chunk { kind, data: data.to_vec() }).collect();
        Ok((json, Chunks { chunks, trailing: trailing.to_vec() }))
    }

    /// Returns the bytes of the file with `json` in its JSON chunk, padded with spaces to a multiple of 4.
    pub fn write(&self, mut json: Vec<u8>) -> Result<Vec<u8>, DocumentError> {
        if !json.len().is_multiple_of(4) {
            // An edit has changed the length, so the old padding is dropped before the new padding is added.
            json.truncate(json.trim_ascii_end().len());
            json.resize(json.len().next_multiple_of(4), b' ');
        }
        let others = self.chunks.iter().map(|chunk| (chunk.kind, chunk.data.as_slice()));
        let chunks = std::iter::once((JSON, json.as_slice())).chain(others);
        let length = |total: usize, data: &[u8]| checked_length(total + CHUNK_HEADER, data.len());
        let total = chunks.clone().try_fold(HEADER, |total, (_, data)| length(total, data).map(|n| n as usize))?;
        let mut out = Vec::with_capacity(total + self.trailing.len());
        out.extend(MAGIC);
        out.extend(VERSION.to_le_bytes());
        out.extend(checked_length(total, 0)?.to_le_bytes());
        for (kind, data) in chunks {
            out.extend(checked_length(data.len(), 0)?.to_le_bytes());
            out.extend(kind);
            out.extend(data);
        }
        out.extend(&self.trailing);
        Ok(out)
    }

    pub fn bin(&self) -> Option<&[u8]> {
        let first = self.chunks.first().filter(|chunk| chunk.kind == BIN)?;
        Some(&first.data)
    }

    /// Replaces the BIN chunk, padded with zeros to a multiple of 4, or removes it.
    pub fn set_bin(&mut self, bin: Option<&[u8]>) {
        if self.bin().is_some() {
            self.chunks.remove(0);
        }
        if let Some(bin) = bin {
            self.append_bin(bin);
        }
    }

    /// Appends to the BIN chunk and pads it with zeros to a multiple of 4. A missing chunk is created.
    pub fn append_bin(&mut self, data: &[u8]) {
        if self.bin().is_none() {
            self.chunks.insert(0, Chunk { kind: BIN, data: Vec::new() });
        }
        if let Some(bin) = self.chunks.first_mut() {
            bin.data.extend(data);
            bin.data.resize(bin.data.len().next_multiple_of(4), 0);
        }
    }
}

/// Returns the sum as a 32-bit length of a GLB.
pub(super) fn checked_length(a: usize, b: usize) -> Result<u32, DocumentError> {
    let sum = a.checked_add(b).and_then(|sum| u32::try_from(sum).ok());
    sum.ok_or(DocumentError::TooLarge)
}

/// Returns type and data of the chunk at `at`.
fn chunk(body: &[u8], at: usize) -> Result<([u8; 4], &[u8]), DocumentError> {
    let truncated = |needed| DocumentError::Chunk { at, needed, found: body.len().saturating_sub(at) };
    let header = at + CHUNK_HEADER;
    let (Some(length), Some(kind)) = (word(body, at), word(body, at + 4)) else {
        return Err(truncated(CHUNK_HEADER));
    };
    if !length.is_multiple_of(4) {
        return Err(DocumentError::ChunkAlignment { at, length });
    }
    let end = header.checked_add(length as usize);
    let data = end.and_then(|end| body.get(header..end));
    let needed = (length as usize).saturating_add(CHUNK_HEADER);
    Ok((kind.to_le_bytes(), data.ok_or(truncated(needed))?))
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().map(|word| u32::from_le_bytes(*word))
}
