//! Replacing textures of materials: old textures are overwritten where nothing else needs them.

mod freed;
mod images;
mod ktx2_sources;
#[cfg(test)]
mod tests;
mod texture;

use std::collections::BTreeSet;

use serde_json::{Map, Value, json};

use super::extensions::{declare, names, undeclare};
use super::json::{Json, JsonError, escaped};
use freed::Freed;
use images::{Placed, place_images, remove_images};

pub use ktx2_sources::name_ktx2_sources;
pub use texture::{NewImage, NewTexture, Slot, references};

const BASISU: &str = "KHR_texture_basisu";

/// Adds `textures` to the document and points their slots at them. Returns their indices.
///
/// An old texture is overwritten if all references to it move. Its images are overwritten too, if no other texture
/// names them, and images that are left over are removed. Textures and images that something else refers to are kept,
/// and new objects are appended. Old objects keep their names. Extensions that no texture has any more are no longer
/// declared.
///
/// # Errors
/// [`JsonError`] if the document is not a valid glTF document.
pub fn add_textures(json: &mut Json, textures: &[NewTexture]) -> Result<Vec<usize>, JsonError> {
    if textures.is_empty() {
        return Ok(Vec::new());
    }
    let root = json.value("")?.unwrap_or_default();
    let mut freed = Freed::of(&root, textures);
    let images = place_images(json, &root, textures, &mut freed)?;
    let mut indices = Vec::with_capacity(textures.len());
    for ((new, replaced), placed) in textures.iter().zip(&freed.replaced).zip(&images) {
        for index in replaced {
            overwrite_texture(json, &root, *index, &new.name, placed)?;
        }
        indices.push(match replaced.first() {
            Some(index) => *index,
            None => push_texture(json, new, placed)?,
        });
    }
    for (new, (texture, index)) in textures.iter().zip(&indices).enumerate() {
        for slot in &texture.slots {
            point_slot(json, &root, slot, *index, |old| freed.becomes.get(&old) == Some(&new))?;
        }
    }
    declare(json, BASISU, textures.iter().any(|t| t.source.is_none()))?;
    remove_images(json, &freed.images)?;
    let replaced = freed.replaced.iter().flatten().filter_map(|index| root.pointer(&format!("/textures/{index}")));
    undeclare_extensions(json, replaced)?;
    Ok(indices)
}

fn push_texture(json: &mut Json, new: &NewTexture, placed: &Placed) -> Result<usize, JsonError> {
    let mut texture = Map::new();
    texture.insert("name".into(), json!(new.name));
    if let Some(sampler) = new.sampler {
        texture.insert("sampler".into(), json!(sampler));
    }
    if let Some(source) = placed.source {
        texture.insert("source".into(), json!(source));
    }
    texture.insert("extensions".into(), json!({ BASISU: { "source": placed.ktx2 } }));
    json.push("/textures", &Value::Object(texture))
}

fn overwrite_texture(
    json: &mut Json,
    root: &Value,
    index: usize,
    name: &str,
    placed: &Placed,
) -> Result<(), JsonError> {
    let at = format!("/textures/{index}");
    let old = root.get("textures").and_then(|textures| textures.get(index)).unwrap_or(&Value::Null);
    match placed.source {
        Some(source) => json.set(&format!("{at}/source"), &source)?,
        None => {
            json.remove(&format!("{at}/source"))?;
        }
    }
    // Engines that know other forms of the old image would prefer them to the new image.
    for other in sources_of(old).filter(|name| *name != BASISU) {
        json.remove(&format!("{at}/extensions/{}", escaped(other)))?;
    }
    json.set(&format!("{at}/extensions/{BASISU}"), &json!({ "source": placed.ktx2 }))?;
    if old.get("name").is_none() {
        json.set(&format!("{at}/name"), name)?;
    }
    Ok(())
}

/// Points `slot` at the new texture `texture`, unless it refers to an old texture that `became` the new one.
fn point_slot(
    json: &mut Json,
    root: &Value,
    slot: &Slot,
    texture: usize,
    became: impl Fn(usize) -> bool,
) -> Result<(), JsonError> {
    let index = format!("{}/index", slot.pointer);
    if let Some(old) = root.pointer(&index) {
        let old = old.as_u64().and_then(|old| usize::try_from(old).ok());
        return if old.is_some_and(became) { Ok(()) } else { json.set(&index, &texture) };
    }
    let mut info = json!({ "index": texture });
    if slot.mapping.tex_coord != 0 {
        info["texCoord"] = json!(slot.mapping.tex_coord);
    }
    if let Some(transform) = &slot.mapping.transform {
        info["extensions"] = json!({ "KHR_texture_transform": transform });
    }
    json.set(&slot.pointer, &info)
}

/// Removes extensions of the textures `replaced` from the declared extensions if no object of the document has them any
/// more. Stops requiring `KHR_texture_basisu` if every texture has an image without it.
fn undeclare_extensions<'v>(json: &mut Json, replaced: impl Iterator<Item = &'v Value>) -> Result<(), JsonError> {
    let mut gone = BTreeSet::new();
    let mut was_strict = false;
    for old in replaced {
        gone.extend(sources_of(old));
        was_strict |= is_strict(old);
    }
    if gone.is_empty() {
        return Ok(());
    }
    let root = json.value("")?.unwrap_or_default();
    let remaining = names(&root);
    gone.retain(|name| !remaining.contains(name));
    let textures = root.get("textures").and_then(Value::as_array);
    let is_optional = was_strict && !textures.into_iter().flatten().any(is_strict);
    undeclare(json, "/extensionsUsed", |name| gone.contains(name))?;
    undeclare(json, "/extensionsRequired", |name| gone.contains(name) || (is_optional && name == BASISU))
}

/// Returns whether `texture` has an image only through `KHR_texture_basisu`.
fn is_strict(texture: &Value) -> bool {
    texture.get("source").is_none() && sources_of(texture).any(|name| name == BASISU)
}

/// Returns the extensions with which `texture` names images.
fn sources_of(texture: &Value) -> impl Iterator<Item = &str> {
    let extensions = texture.get("extensions").and_then(Value::as_object).into_iter().flatten();
    extensions.filter(|(_, extension)| extension.get("source").is_some()).map(|(name, _)| name.as_str())
}
