//! Pointing materials at new textures, in place where nothing else needs the old one.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::json::{Json, JsonError};
use super::material::Mapping;

/// An image to add to the document.
#[derive(Clone, Debug, PartialEq)]
pub enum NewImage {
    /// A file beside the document, by its URI.
    File(String),
    /// A buffer view of the document.
    BufferView {
        /// Index into `bufferViews`.
        view: usize,
        /// Media type of its bytes.
        mime: &'static str,
    },
}

/// A texture to add to the document.
#[derive(Clone, Debug, PartialEq)]
pub struct NewTexture {
    /// The KTX2 file.
    pub ktx2: NewImage,
    /// What the core `source` names; nothing in the strict form.
    pub source: Option<NewImage>,
    /// Index into `samplers`.
    pub sampler: Option<usize>,
    /// The materials' references to it.
    pub slots: Vec<Slot>,
}

/// A place in a material that refers to a texture.
#[derive(Clone, Debug, PartialEq)]
pub struct Slot {
    /// JSON pointer of the `textureInfo` object.
    pub pointer: String,
    /// Texture coordinates, for slots that are new.
    pub mapping: Mapping,
}

/// Adds `textures` to the document and points their slots at them; returns their indices.
///
/// A texture and its images are overwritten in place when all references to them move to the same new texture, so that
/// no orphans stay behind; otherwise new objects are appended and the old ones kept.
///
/// # Errors
/// [`JsonError`] when the document does not have the shape of a glTF.
pub fn add_textures(json: &mut Json, textures: &[NewTexture]) -> Result<Vec<usize>, JsonError> {
    let root = json.value("")?.unwrap_or_default();
    let mut free = FreeObjects::of(&root, textures);
    let mut indices = Vec::with_capacity(textures.len());
    for (new, replaced) in textures.iter().zip(free.replaced.clone()) {
        let ktx2 = free.place_image(json, &new.ktx2)?;
        let source = match &new.source {
            None => None,
            Some(image) if *image == new.ktx2 => Some(ktx2),
            Some(image) => Some(free.place_image(json, image)?),
        };
        indices.push(place_texture(json, new, replaced, ktx2, source)?);
    }
    for (new, index) in textures.iter().zip(&indices) {
        for slot in &new.slots {
            point(json, slot, *index)?;
        }
    }
    if !textures.is_empty() {
        declare(json, "KHR_texture_basisu", textures.iter().any(|t| t.source.is_none()))?;
    }
    Ok(indices)
}

/// Adds `name` to `extensionsUsed` and, if `required`, to `extensionsRequired`, once.
///
/// # Errors
/// [`JsonError`] when either is not an array.
pub fn declare(json: &mut Json, name: &str, required: bool) -> Result<(), JsonError> {
    let lists = [Some("/extensionsUsed"), required.then_some("/extensionsRequired")];
    for list in lists.into_iter().flatten() {
        let names: Vec<String> = json.read(list)?.unwrap_or_default();
        if !names.iter().any(|n| n == name) {
            json.push(list, name)?;
        }
    }
    Ok(())
}

fn place_texture(
    json: &mut Json,
    new: &NewTexture,
    replaced: Option<usize>,
    ktx2: usize,
    source: Option<usize>,
) -> Result<usize, JsonError> {
    let Some(index) = replaced else {
        let mut texture = serde_json::Map::new();
        if let Some(sampler) = new.sampler {
            texture.insert("sampler".into(), json!(sampler));
        }
        if let Some(source) = source {
            texture.insert("source".into(), json!(source));
        }
        texture.insert("extensions".into(), json!({ "KHR_texture_basisu": { "source": ktx2 } }));
        return json.push("/textures", &Value::Object(texture));
    };
    let at = format!("/textures/{index}");
    match source {
        Some(source) => json.set(&format!("{at}/source"), &source)?,
        None => {
            json.remove(&format!("{at}/source"))?;
        }
    }
    // Other forms of the old image would win over the new one in engines that know them.
    let extensions: serde_json::Map<String, Value> = json.read(&format!("{at}/extensions"))?.unwrap_or_default();
    for (name, extension) in extensions {
        if extension.get("source").is_some() && name != "KHR_texture_basisu" {
            let name = name.replace('~', "~0").replace('/', "~1");
            json.remove(&format!("{at}/extensions/{name}"))?;
        }
    }
    json.set(&format!("{at}/extensions/KHR_texture_basisu"), &json!({ "source": ktx2 }))?;
    Ok(index)
}

fn point(json: &mut Json, slot: &Slot, texture: usize) -> Result<(), JsonError> {
    let index = format!("{}/index", slot.pointer);
    if json.text(&index).is_some() {
        return json.set(&index, &texture);
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

/// Objects that no one needs once the slots have moved.
struct FreeObjects {
    /// For each new texture the old one that it takes the place of.
    replaced: Vec<Option<usize>>,
    /// Images of replaced textures.
    images: Vec<usize>,
}

impl FreeObjects {
    fn of(root: &Value, textures: &[NewTexture]) -> Self {
        // Which new texture each reference of a material moves to, if any.
        let mut moves: BTreeMap<usize, Vec<Option<usize>>> = BTreeMap::new();
        for (pointer, old) in references(root) {
            let new = textures.iter().position(|t| t.slots.iter().any(|s| s.pointer == pointer));
            moves.entry(old).or_default().push(new);
        }
        let mut replaced = vec![None; textures.len()];
        for (old, targets) in &moves {
            if let Some(new) = targets[0].filter(|new| targets.iter().all(|t| *t == Some(*new))) {
                replaced[new].get_or_insert(*old);
            }
        }
        let list = root.get("textures").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
        let in_use: Vec<usize> = list
            .iter()
            .enumerate()
            .filter(|(index, _)| !replaced.contains(&Some(*index)))
            .flat_map(|(_, texture)| images_of(texture))
            .collect();
        let mut images: Vec<usize> = replaced
            .iter()
            .flatten()
            .filter_map(|index| list.get(*index))
            .flat_map(images_of)
            .filter(|image| !in_use.contains(image))
            .collect();
        images.sort_unstable();
        images.dedup();
        images.reverse();
        Self { replaced, images }
    }

    /// Writes `image` over a free one, lowest index first, or appends it; returns its index.
    fn place_image(&mut self, json: &mut Json, image: &NewImage) -> Result<usize, JsonError> {
        let Some(index) = self.images.pop() else {
            return match image {
                NewImage::File(uri) => json.push("/images", &json!({ "uri": uri })),
                NewImage::BufferView { view, mime } => {
                    json.push("/images", &json!({ "bufferView": view, "mimeType": mime }))
                }
            };
        };
        let at = format!("/images/{index}");
        match image {
            // Without a media type: `image/ktx2` would make validators warn, and the dual form fail in some.
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
        Ok(index)
    }
}

/// Images that a texture names, whatever the extension.
fn images_of(texture: &Value) -> Vec<usize> {
    let extensions = texture.get("extensions").and_then(Value::as_object);
    let sources = extensions.into_iter().flat_map(|e| e.values()).filter_map(|e| e.get("source"));
    let all = texture.get("source").into_iter().chain(sources);
    all.filter_map(Value::as_u64).filter_map(|i| usize::try_from(i).ok()).collect()
}

/// Pointers of all objects that may be a `textureInfo`, with the texture that each names: whatever has an `index`, so
/// that textures of unknown extensions count as needed.
pub(crate) fn references(root: &Value) -> Vec<(String, usize)> {
    fn walk(value: &Value, pointer: &str, found: &mut Vec<(String, usize)>) {
        match value {
            Value::Object(members) => {
                if let Some(index) = members.get("index").and_then(Value::as_u64) {
                    found.push((pointer.to_owned(), usize::try_from(index).unwrap_or(usize::MAX)));
                }
                for (key, member) in members {
                    let key = key.replace('~', "~0").replace('/', "~1");
                    walk(member, &format!("{pointer}/{key}"), found);
                }
            }
            Value::Array(elements) => {
                for (index, element) in elements.iter().enumerate() {
                    walk(element, &format!("{pointer}/{index}"), found);
                }
            }
            _ => {}
        }
    }
    let mut found = Vec::new();
    walk(root, "", &mut found);
    found
}
