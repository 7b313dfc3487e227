//! The output document: a copy of the source in the container asked for.

use std::path::PathBuf;

use serde::Deserialize;
use serde_json::{Value, json};

use super::asset::NewFile;
use super::source::{Source, SourceError};
use crate::gltf::document::{Container, Document, DocumentError};
use crate::gltf::json::{Json, JsonError};
use crate::gltf::uri::{Uri, UriError, encode_path};

/// Why the document cannot be put into its container.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)]
pub enum ContainerError {
    #[error(transparent)]
    Document(#[from] DocumentError),
    #[error(transparent)]
    Json(#[from] JsonError),
    #[error(transparent)]
    Source(#[from] SourceError),
    /// A reference of an image or a buffer.
    #[error("{pointer}: {error}")]
    Uri {
        /// JSON pointer of the reference.
        pointer: String,
        /// What is wrong with it.
        error: UriError,
    },
    /// Buffers that cannot be joined.
    #[error(
        "expected buffer views without extensions to join {count} buffers in one .glb, found some that refer to buffers \
         in ways of their own; bake to .gltf, without --glb"
    )]
    Buffers {
        /// How many buffers there are.
        count: usize,
    },
}

/// The document as a .gltf. The BIN chunk of a .glb becomes a file of its own, which is returned with its path.
pub fn to_gltf(source: &Source<'_>) -> Result<(Document, Option<NewFile>), ContainerError> {
    if source.document.container() == Container::Gltf {
        return Ok((source.document.clone(), None));
    }
    let mut json = source.document.json().clone();
    let Some(bin) = source.document.bin() else {
        return Ok((Document::gltf(json), None));
    };
    let path = format!("{}.roughcast/{}.bin", source.stem, source.stem);
    json.set("/buffers/0/uri", &encode_path(&path))?;
    let length: usize = json.read("/buffers/0/byteLength")?.unwrap_or(bin.len());
    let bytes = bin.get(..length).unwrap_or(bin).to_vec();
    Ok((Document::gltf(json), Some(NewFile { path: PathBuf::from(path), bytes })))
}

/// The document as a .glb, with every buffer in its BIN chunk.
pub fn to_glb(source: &Source<'_>) -> Result<Document, ContainerError> {
    let json = source.document.json();
    let uris = buffer_uris(json)?;
    if source.document.container() == Container::Glb && uris.iter().all(Option::is_none) {
        return Ok(source.document.clone());
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
        bin.extend_from_slice(&source.buffer(index)?);
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

/// Removes buffer views from the end of `json` as long as they held images of `source` that were baked and nothing refers
/// to them any more, and their bytes from `bin`, which is buffer 0. Views before one in use stay, since extensions may
/// number them in ways of their own.
pub fn trim_views(json: &mut Json, source: &Json, bin: &mut Vec<u8>) -> Result<(), ContainerError> {
    let root: Value = json.value("")?.unwrap_or_default();
    let views = root.get("bufferViews").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let mut used = Vec::new();
    for (key, value) in root.as_object().into_iter().flatten().filter(|(key, _)| *key != "bufferViews") {
        view_references(key, value, &mut used);
    }
    let of_images = image_views(source)?;
    let is_free = |view: usize| of_images.contains(&view) && !used.contains(&view);
    let kept = (0..views.len()).rev().find(|view| !is_free(*view)).map_or(0, |last| last + 1);
    if kept == views.len() || views.iter().any(|v| v.get("extensions").is_some()) {
        return Ok(());
    }
    let end = |view: &Value| {
        let number = |key: &str| view.get(key).and_then(Value::as_u64).unwrap_or(0);
        if number("buffer") == 0 { number("byteOffset").saturating_add(number("byteLength")) } else { 0 }
    };
    let length = views[..kept].iter().map(end).max().unwrap_or(0);
    let length = usize::try_from(length).map_or(bin.len(), |length| length.min(bin.len()));
    if kept == 0 || length == 0 {
        return Ok(());
    }
    json.retain("/bufferViews", |index| index < kept)?;
    json.set("/buffers/0/byteLength", &length)?;
    bin.truncate(length);
    Ok(())
}

/// Numbers of buffer views in `value`, which is the member `key` of some object: whatever has that name.
fn view_references(key: &str, value: &Value, found: &mut Vec<usize>) {
    match value {
        Value::Object(members) => members.iter().for_each(|(key, member)| view_references(key, member, found)),
        Value::Array(elements) => elements.iter().for_each(|element| view_references(key, element, found)),
        _ if key == "bufferView" => {
            found.extend(value.as_u64().map(|view| usize::try_from(view).unwrap_or(usize::MAX)));
        }
        _ => {}
    }
}

/// Adds `bytes` to the BIN chunk of a .glb; returns the index of a buffer view of them.
pub fn embed(document: &mut Document, bytes: &[u8]) -> Result<usize, ContainerError> {
    let (offset, length) = document.append_bin(bytes)?;
    let view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": length });
    Ok(document.json_mut().push("/bufferViews", &view)?)
}

/// Moves every image that is a file into the BIN chunk of a .glb.
pub fn embed_images(document: &mut Document, source: &Source<'_>) -> Result<(), ContainerError> {
    for (index, uri) in image_uris(document.json())?.into_iter().enumerate() {
        let Some(uri) = uri else { continue };
        let bytes = source.uri(&uri)?;
        let mime = match bytes.as_slice() {
            [0x89, b'P', b'N', b'G', ..] => "image/png",
            [0xAB, b'K', b'T', b'X', ..] => "image/ktx2",
            [b'R', b'I', b'F', b'F', ..] => "image/webp",
            _ => "image/jpeg",
        };
        let view = embed(document, &bytes)?;
        let json = document.json_mut();
        json.remove(&format!("/images/{index}/uri"))?;
        json.set(&format!("/images/{index}/bufferView"), &view)?;
        json.set(&format!("/images/{index}/mimeType"), mime)?;
    }
    Ok(())
}

/// The files that images and buffers of `json` name, without repetition, relative to the document.
pub fn files(json: &Json) -> Result<Vec<PathBuf>, ContainerError> {
    named(&[("images", image_uris(json)?), ("buffers", buffer_uris(json)?)])
}

/// The same of buffers alone.
pub fn buffer_files(json: &Json) -> Result<Vec<PathBuf>, ContainerError> {
    named(&[("buffers", buffer_uris(json)?)])
}

fn named(lists: &[(&str, Vec<Option<String>>)]) -> Result<Vec<PathBuf>, ContainerError> {
    let mut files = Vec::new();
    for (array, uris) in lists {
        for (index, uri) in uris.iter().enumerate() {
            let Some(uri) = uri else { continue };
            let parsed =
                Uri::parse(uri).map_err(|error| ContainerError::Uri { pointer: format!("{array}[{index}]"), error })?;
            if let Uri::Path(path) = parsed
                && !files.contains(&path)
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

/// The buffer views that images name.
fn image_views(json: &Json) -> Result<Vec<usize>, JsonError> {
    #[derive(Deserialize)]
    #[serde(rename_all = "camelCase")]
    struct Image {
        buffer_view: Option<usize>,
    }
    let images: Vec<Image> = json.read("/images")?.unwrap_or_default();
    Ok(images.into_iter().filter_map(|i| i.buffer_view).collect())
}

fn buffer_uris(json: &Json) -> Result<Vec<Option<String>>, JsonError> {
    let buffers: Vec<Named> = json.read("/buffers")?.unwrap_or_default();
    Ok(buffers.into_iter().map(|b| b.uri).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trimmed(json: &Value, length: usize) -> (Value, usize) {
        let before = json!({ "images": [{ "bufferView": 1 }, { "bufferView": 2 }] });
        let before = Json::parse(before.to_string().as_bytes()).unwrap();
        let mut json = Json::parse(json.to_string().as_bytes()).unwrap();
        let mut bin = vec![0; length];
        trim_views(&mut json, &before, &mut bin).unwrap();
        (json.value("").unwrap().unwrap(), bin.len())
    }

    fn document(last_image: &Value) -> Value {
        json!({
            "accessors": [{ "bufferView": 0 }],
            "images": [{ "uri": "new.png" }, last_image],
            "buffers": [{ "byteLength": 300 }],
            "bufferViews": [
                { "buffer": 0, "byteLength": 100 },
                { "buffer": 0, "byteOffset": 100, "byteLength": 120 },
                { "buffer": 0, "byteOffset": 220, "byteLength": 80 },
            ],
        })
    }

    #[test]
    fn views_of_replaced_images_go_with_their_bytes() {
        let (json, length) = trimmed(&document(&json!({ "uri": "other.png" })), 300);
        assert_eq!(json["bufferViews"].as_array().unwrap().len(), 1);
        assert_eq!((&json["buffers"][0]["byteLength"], length), (&json!(100), 100));
    }

    #[test]
    fn views_before_one_in_use_stay() {
        let before = document(&json!({ "bufferView": 2 }));
        assert_eq!(trimmed(&before, 300), (before, 300));
        // A view that was never an image's may be a table's.
        let mut tables = document(&json!({ "uri": "other.png" }));
        let views = tables["bufferViews"].as_array_mut().unwrap();
        views.push(json!({ "buffer": 0, "byteOffset": 300, "byteLength": 20 }));
        assert_eq!(trimmed(&tables, 320), (tables, 320));
        let mut compressed = document(&json!({ "uri": "other.png" }));
        compressed["bufferViews"][0]["extensions"] = json!({ "EXT_meshopt_compression": { "buffer": 1 } });
        assert_eq!(trimmed(&compressed, 300), (compressed, 300));
    }
}
