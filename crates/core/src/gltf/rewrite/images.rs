//! The images of new textures, which overwrite images of the replaced textures if possible.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use super::freed::{Freed, images_of};
use super::texture::{NewImage, NewTexture};
use crate::gltf::extensions::are_known;
use crate::gltf::json::{Json, JsonError, escaped};

/// Indices of the images of a new texture.
pub struct Placed {
    /// The KTX2 file.
    pub ktx2: usize,
    /// The image of the core `source`.
    pub source: Option<usize>,
}

/// Writes the images of `textures` and returns their indices. Removes the images that it overwrites from `freed`.
pub fn place_images(
    json: &mut Json,
    root: &Value,
    textures: &[NewTexture],
    freed: &mut Freed,
) -> Result<Vec<Placed>, JsonError> {
    // Each texture first takes images of the textures that it replaces, so that no other texture takes them.
    let replaced: Vec<Vec<usize>> = textures
        .iter()
        .zip(&freed.replaced)
        .map(|(new, replaced)| {
            let old = replaced.iter().filter_map(|index| root.get("textures")?.get(index));
            let old_images: Vec<usize> = old.flat_map(images_of).collect();
            let count = if new.other_source().is_some() { 2 } else { 1 };
            old_images.into_iter().filter(|image| freed.images.remove(image)).take(count).collect()
        })
        .collect();
    let mut placed = Vec::with_capacity(textures.len());
    for (new, replaced) in textures.iter().zip(replaced) {
        let mut replaced = replaced.into_iter();
        let mut place = |image: &NewImage| match replaced.next() {
            Some(index) => overwrite(json, root, index, image, &new.name, true).map(|()| index),
            None => match freed.images.pop_first() {
                Some(index) => overwrite(json, root, index, image, &new.name, false).map(|()| index),
                None => push(json, image, &new.name),
            },
        };
        let ktx2 = place(&new.ktx2)?;
        let source = new.other_source().map(&mut place).transpose()?;
        placed.push(Placed { ktx2, source: source.or_else(|| new.source.as_ref().map(|_| ktx2)) });
    }
    Ok(placed)
}

impl NewTexture {
    /// Returns the image of the core `source`, unless it is the KTX2 file.
    fn other_source(&self) -> Option<&NewImage> {
        self.source.as_ref().filter(|source| **source != self.ktx2)
    }
}

fn push(json: &mut Json, image: &NewImage, name: &str) -> Result<usize, JsonError> {
    match image {
        NewImage::File(uri) => json.push("/images", &json!({ "name": name, "uri": uri })),
        NewImage::BufferView { view, mime } => {
            json.push("/images", &json!({ "name": name, "bufferView": view, "mimeType": mime }))
        }
    }
}

/// Writes `image` over image `index`. An existing name stays if `keeps_name`.
fn overwrite(
    json: &mut Json,
    root: &Value,
    index: usize,
    image: &NewImage,
    name: &str,
    keeps_name: bool,
) -> Result<(), JsonError> {
    let at = format!("/images/{index}");
    match image {
        // There is no media type: with `image/ktx2` validators warn, and the fallback form fails in some of them.
        NewImage::File(uri) => {
            json.remove(&format!("{at}/bufferView"))?;
            json.remove(&format!("{at}/mimeType"))?;
            json.set(&format!("{at}/uri"), uri)?;
        }
        NewImage::BufferView { view, mime } => {
            json.remove(&format!("{at}/uri"))?;
            json.set(&format!("{at}/bufferView"), view)?;
            json.set(&format!("{at}/mimeType"), mime)?;
        }
    }
    let has_name = root.get("images").and_then(|images| images.get(index)?.get("name")).is_some();
    if has_name && keeps_name { Ok(()) } else { json.set(&format!("{at}/name"), name) }
}

/// Removes `images`, which no texture names, unless an extension may refer to images in an unknown way.
pub fn remove_images(json: &mut Json, images: &BTreeSet<usize>) -> Result<(), JsonError> {
    if images.is_empty() {
        return Ok(());
    }
    let root = json.value("")?.unwrap_or_default();
    if !are_known(&root) {
        return Ok(());
    }
    let removed: Vec<usize> = images.iter().copied().collect();
    let renumbered = |image: &Value| {
        let image = usize::try_from(image.as_u64()?).ok()?;
        let before = removed.partition_point(|removed| *removed < image);
        (before > 0).then(|| image - before)
    };
    let textures = root.get("textures").and_then(Value::as_array).into_iter().flatten().enumerate();
    for (index, texture) in textures {
        if let Some(image) = texture.get("source").and_then(renumbered) {
            json.set(&format!("/textures/{index}/source"), &image)?;
        }
        for (name, extension) in texture.get("extensions").and_then(Value::as_object).into_iter().flatten() {
            if let Some(image) = extension.get("source").and_then(renumbered) {
                json.set(&format!("/textures/{index}/extensions/{}/source", escaped(name)), &image)?;
            }
        }
    }
    json.retain("/images", |index| !images.contains(&index))
}
