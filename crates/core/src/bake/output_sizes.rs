//! What the bytes of a document and of its new files hold.

use std::collections::BTreeSet;
use std::ffi::OsStr;

use serde_json::Value;

use super::error::ContainerError;
use super::new_file::NewFile;
use crate::gltf::document::{Document, view_range};
use crate::report::OutputSizes;

/// Returns the sizes of `document`, which has `bytes` bytes as a file, and of `files` beside it. Files that are copied
/// are not counted.
///
/// # Errors
/// [`ContainerError`] if the document is no JSON object.
pub fn output_sizes(document: &Document, bytes: usize, files: &[NewFile]) -> Result<OutputSizes, ContainerError> {
    let root: Value = document.json().value("")?.unwrap_or_default();
    let fallbacks = Fallbacks::of(&root);
    let mut sizes = OutputSizes::default();
    let mut bin = document.bin().unwrap_or_default();
    sizes.json = (bytes as u64).saturating_sub(bin.len() as u64);
    for file in files {
        match file.path.extension().and_then(OsStr::to_str) {
            Some("ktx2") => sizes.ktx2 += file.bytes.len() as u64,
            Some("png") => sizes.fallback += file.bytes.len() as u64,
            // The new files of a bake are KTX2 textures, their PNG copies, and the buffer of a .glb that becomes a
            // .gltf.
            _ => bin = &file.bytes,
        }
    }
    let mut images = 0;
    for (index, view) in image_views(&root) {
        // An image of another buffer, or one outside of the chunk, has no bytes here.
        let Some(image) = view_range(&root, view).ok().filter(|(buffer, _)| *buffer == 0) else { continue };
        let Some(image) = bin.get(image.1) else { continue };
        let size = if image.starts_with(&::ktx2::MAGIC) {
            &mut sizes.ktx2
        } else if fallbacks.0.contains(&index) {
            &mut sizes.fallback
        } else {
            &mut sizes.images
        };
        *size += image.len() as u64;
        images += image.len() as u64;
    }
    sizes.geometry += (bin.len() as u64).saturating_sub(images);
    Ok(sizes)
}

/// The images that are shown only where `KHR_texture_basisu` is not known.
struct Fallbacks(BTreeSet<u64>);

impl Fallbacks {
    fn of(root: &Value) -> Self {
        let textures = root.get("textures").and_then(Value::as_array).into_iter().flatten();
        let has_ktx2 = |texture: &&Value| texture.pointer("/extensions/KHR_texture_basisu/source").is_some();
        Self(textures.filter(has_ktx2).filter_map(|texture| texture.get("source")?.as_u64()).collect())
    }
}

/// Returns the images in buffer views, each with the index of its view. Views that several images share come once.
fn image_views(root: &Value) -> Vec<(u64, usize)> {
    let images = root.get("images").and_then(Value::as_array).into_iter().flatten();
    let view = |image: &Value| usize::try_from(image.get("bufferView")?.as_u64()?).ok();
    let mut seen = BTreeSet::new();
    (0..)
        .zip(images)
        .filter_map(|(index, image)| Some((index, view(image).filter(|view| seen.insert(*view))?)))
        .collect()
}

#[cfg(test)]
mod tests;
