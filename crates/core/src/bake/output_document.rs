//! The output document: a copy of the source in the requested container.

use std::collections::HashSet;
use std::ffi::OsStr;
use std::path::PathBuf;

use serde::Deserialize;
use serde_json::{Value, json};

use super::compact::compact;
use super::error::ContainerError;
use super::names::portable_stem;
use super::new_file::NewFile;
use super::reader::Reader;
use super::source::{Source, SourceError};
use crate::foreign::Foreign;
use crate::gltf::document::{Container, Document, DocumentError};
use crate::gltf::json::{Json, JsonError};
use crate::gltf::uri::{Uri, encode_path};
use crate::image::FileFormat;

/// Returns the document as a .gltf. If buffer 0 is the BIN chunk of a .glb, it becomes a file, which is returned with
/// its path.
pub fn to_gltf(source: &Source<'_>) -> Result<(Document, Option<NewFile>), ContainerError> {
    if source.document.container() == Container::Gltf {
        return Ok((source.document.clone(), None));
    }
    let mut json = source.document.json().clone();
    let Some(bin) = source.document.buffer_0() else {
        return Ok((Document::gltf(json), None));
    };
    let stem = portable_stem(source.output_stem);
    let path = format!("{stem}.roughcast/{stem}.bin");
    json.set("/buffers/0/uri", &encode_path(&path))?;
    let length: usize = json.read("/buffers/0/byteLength")?.unwrap_or(bin.len());
    let bytes = bin.get(..length).unwrap_or(bin).to_vec();
    Ok((Document::gltf(json), Some(NewFile { path: PathBuf::from(path), bytes })))
}

/// Returns the document as a .glb with every buffer in its BIN chunk. `reader` keeps all buffers.
pub fn to_glb(reader: &Reader<'_>) -> Result<Document, ContainerError> {
    let source = reader.source;
    let json = source.document.json();
    let uris = buffer_uris(json)?;
    if source.document.container() == Container::Glb && uris.iter().all(Option::is_none) {
        let mut document = source.document.clone();
        if uris.is_empty() {
            // No buffer refers to the BIN chunk.
            document.set_bin(None)?;
        }
        return Ok(document);
    }
    let mut json = json.clone();
    let views: Vec<Value> = json.read("/bufferViews")?.unwrap_or_default();
    if uris.len() > 1 && views.iter().any(|v| v.get("extensions").is_some()) {
        return Err(ContainerError::Buffers { count: uris.len() });
    }
    let mut bin = Vec::new();
    let mut starts = Vec::new();
    for index in 0..uris.len() {
        bin.resize(bin.len().next_multiple_of(4), 0);
        starts.push(bin.len());
        bin.extend_from_slice(reader.buffer(index)?);
    }
    for (index, view) in views.iter().enumerate() {
        let number = |key: &str| view.get(key).and_then(Value::as_u64).and_then(|n| usize::try_from(n).ok());
        match number("buffer") {
            None | Some(0) => {}
            Some(buffer) => {
                let start = starts
                    .get(buffer)
                    .copied()
                    .ok_or_else(|| DocumentError::Missing { pointer: format!("/buffers/{buffer}") })?;
                json.set(&format!("/bufferViews/{index}/buffer"), &0)?;
                let offset = start.saturating_add(number("byteOffset").unwrap_or(0));
                json.set(&format!("/bufferViews/{index}/byteOffset"), &offset)?;
            }
        }
    }
    if uris.is_empty() {
        return Ok(Document::glb(json, None));
    }
    json.remove("/buffers/0/uri")?;
    json.set("/buffers/0/byteLength", &bin.len())?;
    json.retain("/buffers", |index| index == 0)?;
    Ok(Document::glb(json, Some(bin)))
}

/// Removes what only replaced images of `source` needed from the BIN chunk of a .glb: see [`compact`].
pub fn compact_glb(document: &mut Document, source: &Document) -> Result<(), ContainerError> {
    if let Some(bin) = document.buffer_0().map(<[u8]>::to_vec) {
        let length = bin.len();
        let bin = compact(document.json_mut(), source.json(), bin)?;
        if bin.as_ref().is_none_or(|bin| bin.len() < length) {
            document.set_bin(bin.as_deref())?;
        }
    }
    Ok(())
}

/// Adds `bytes` to the BIN chunk of a .glb and returns the index of their buffer view.
pub fn embed(document: &mut Document, bytes: &[u8]) -> Result<usize, ContainerError> {
    let (offset, length) = document.append_bin(bytes)?;
    let view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": length });
    Ok(document.json_mut().push("/bufferViews", &view)?)
}

/// Moves every image that is a file into the BIN chunk of a .glb. Returns whether there was one.
pub fn embed_images(document: &mut Document, source: &Source<'_>) -> Result<bool, ContainerError> {
    let mut is_any_moved = false;
    for (index, uri) in image_uris(document.json())?.into_iter().enumerate() {
        let Some(uri) = uri else { continue };
        let bytes = source.uri(&uri)?;
        let view = embed(document, &bytes)?;
        let json = document.json_mut();
        let declared = json.value(&format!("/images/{index}/mimeType"))?;
        let mime = mime_type(&bytes, &uri, declared.as_ref().and_then(Value::as_str));
        json.remove(&format!("/images/{index}/uri"))?;
        json.set(&format!("/images/{index}/bufferView"), &view)?;
        json.set(&format!("/images/{index}/mimeType"), mime)?;
        is_any_moved = true;
    }
    Ok(is_any_moved)
}

/// Most bytes of a Git LFS pointer, by the specification of Git LFS.
const MAX_POINTER: u64 = 1024;

/// Checks that no image file which `json` names is a Git LFS pointer, an empty file or another small file that holds no
/// image. A bake reads only some of the images, and the others would be copied as they are.
pub fn check_images(json: &Json, source: &Source<'_>) -> Result<(), ContainerError> {
    for path in named(&[("images", image_uris(json)?)])? {
        if source.files.known_length(&path).is_none_or(|length| length > MAX_POINTER) {
            continue;
        }
        let bytes = source.files.read(&path).map_err(|error| SourceError::Read { path: path.clone(), error })?;
        if let Some(found) = Foreign::detect(&bytes) {
            return Err(SourceError::ForeignImage { path, found }.into());
        }
    }
    Ok(())
}

/// Returns the MIME type of an image that was at `uri`. The signature decides on formats that glTF and its extensions
/// name. Any other image keeps the type that the document or the data URI declares, if there is one.
fn mime_type<'a>(bytes: &[u8], uri: &'a str, declared: Option<&'a str>) -> &'a str {
    let parsed = Uri::parse(uri).ok();
    let (extension, in_uri) = match &parsed {
        Some(Uri::Path(path)) => (path.extension().and_then(OsStr::to_str), None),
        Some(Uri::Data(data)) => (None, Some(data.mime())),
        None => (None, None),
    };
    let detected = FileFormat::detect(bytes, extension);
    let is_known = detected.is_some_and(FileFormat::is_in_gltf);
    let declared = declared.or(in_uri).filter(|declared| !is_known && !declared.is_empty());
    declared.or(detected.map(FileFormat::mime_type)).unwrap_or("application/octet-stream")
}

/// Returns the files that images and buffers of `json` name, without repetition, relative to the document.
pub fn files(json: &Json) -> Result<Vec<PathBuf>, ContainerError> {
    named(&[("images", image_uris(json)?), ("buffers", buffer_uris(json)?)])
}

/// Returns the files that buffers of `json` name.
pub fn buffer_files(json: &Json) -> Result<Vec<PathBuf>, ContainerError> {
    named(&[("buffers", buffer_uris(json)?)])
}

fn named(lists: &[(&str, Vec<Option<String>>)]) -> Result<Vec<PathBuf>, ContainerError> {
    let (mut files, mut seen) = (Vec::new(), HashSet::new());
    for (array, uris) in lists {
        for (index, uri) in uris.iter().enumerate() {
            let Some(uri) = uri else { continue };
            let parsed =
                Uri::parse(uri).map_err(|error| ContainerError::Uri { pointer: format!("{array}[{index}]"), error })?;
            if let Uri::Path(path) = parsed
                && seen.insert(path.clone())
            {
                files.push(path);
            }
        }
    }
    Ok(files)
}

#[derive(Deserialize)]
struct Named {
    uri: Option<String>,
}

fn image_uris(json: &Json) -> Result<Vec<Option<String>>, JsonError> {
    let images: Vec<Named> = json.read("/images")?.unwrap_or_default();
    Ok(images.into_iter().map(|i| i.uri).collect())
}

fn buffer_uris(json: &Json) -> Result<Vec<Option<String>>, JsonError> {
    let buffers: Vec<Named> = json.read("/buffers")?.unwrap_or_default();
    Ok(buffers.into_iter().map(|b| b.uri).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mime_types_follow_the_signature_then_the_document_then_the_extension() {
        let (exr, tga): (&[u8], &[u8]) = (b"\x76\x2f\x31\x01\x02", b"\0\0\x02\0");
        for (bytes, uri, declared, expected) in [
            (&b"\x89PNG\r\n\x1a\n"[..], "a.jpg", Some("image/jpeg"), "image/png"),
            (b"\xff\xd8\xff\xe0", "a", None, "image/jpeg"),
            (b"RIFF\x10\0\0\0WEBPVP8 ", "a.webp", None, "image/webp"),
            (b"\xabKTX 20\xbb\r\n\x1a\n", "a.ktx2", None, "image/ktx2"),
            (exr, "a.exr", None, "image/x-exr"),
            (exr, "a.exr", Some("image/aces"), "image/aces"),
            (tga, "a.TGA", None, "image/x-tga"),
            (b"II*\0", "a.tif", None, "image/tiff"),
            (b"#?RADIANCE\n", "a.hdr", None, "image/vnd.radiance"),
            (b"DDS ", "a.dds", Some("image/vnd-ms.dds"), "image/vnd-ms.dds"),
            (b"\0\0\0\x20ftypavif", "data:image/avif;base64,AAAAIGZ0eXBhdmlm", None, "image/avif"),
            (b"DDS ", "data:,DDS ", Some(""), "application/octet-stream"),
        ] {
            assert_eq!(mime_type(bytes, uri, declared), expected, "{uri}");
        }
    }
}
