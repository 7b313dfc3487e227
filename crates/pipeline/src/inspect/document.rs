//! The facts of a glTF document: its materials and their textures.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::Value;

use super::texture::{TextureFacts, inspect_texture};
use crate::check::ReferencedFiles;
use crate::decode::decode;
use crate::gltf::document::{DocumentError, check_version};
use crate::gltf::rewrite::references;
use crate::gltf::roughness_pyramid::{EXTENSION, RoughnessPyramid};
use crate::gltf::texture::ImageLocation;
use crate::image::{DecodeOptions, FileFormat};

/// A glTF document.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct DocumentFacts {
    /// `asset.generator`.
    pub generator: Option<String>,
    /// `extensionsUsed`.
    pub extensions_used: Vec<String>,
    /// `extensionsRequired`.
    pub extensions_required: Vec<String>,
    /// Its materials, in the file's order.
    pub materials: Vec<MaterialFacts>,
}

/// A material.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct MaterialFacts {
    /// Its name, or `material <index>`.
    pub name: String,
    /// `roughnessFactor`.
    pub roughness_factor: f64,
    /// References to textures.
    pub slots: Vec<SlotFacts>,
    /// `ROUGHCAST_materials_roughness_pyramid`, unchanged.
    pub pyramid: Option<Value>,
    /// Errors in the material.
    pub errors: Vec<String>,
}

/// A reference of a material to a texture.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct SlotFacts {
    /// JSON pointer inside the material, without the leading slash.
    pub slot: String,
    /// Index into `textures`.
    pub texture: usize,
    /// Its images: `source` and those of extensions.
    pub images: Vec<ImageFacts>,
}

/// An image of a texture.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct ImageFacts {
    /// `source`, or the extension that names it.
    pub named_by: String,
    /// Index into `images`.
    pub image: usize,
    /// Its URI, shortened where it holds data, or `bufferViews[n]`.
    pub location: String,
    /// Facts of an image that is not KTX2.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub picture: Option<PictureFacts>,
    /// Facts of a KTX2.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ktx2: Option<TextureFacts>,
    /// The reason if there are no facts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
}

/// An image that is not KTX2.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PictureFacts {
    /// `PNG`, `JPEG` and so on.
    pub format: String,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// 1 to 4.
    pub channels: u32,
    /// Bits of a channel as decoded.
    pub bits: u32,
}

/// Reads the facts of the document whose JSON is `root`. Errors inside the document are among the facts.
///
/// # Errors
/// [`DocumentError`] when the document is of another version than glTF 2.0.
pub fn inspect_document(root: &Value, referenced: &ReferencedFiles<'_>) -> Result<DocumentFacts, DocumentError> {
    check_version(root)?;
    let texts = |key: &str| {
        let list = root.get(key).and_then(Value::as_array).into_iter().flatten();
        list.filter_map(Value::as_str).map(str::to_owned).collect()
    };
    let mut slots = slots(root);
    let mut images = Images { root, referenced, known: BTreeMap::new() };
    let materials = root.get("materials").and_then(Value::as_array).into_iter().flatten().enumerate();
    let materials =
        materials.map(|(index, material)| material_facts(index, material, slots.remove(&index), root, &mut images));
    Ok(DocumentFacts {
        generator: root.pointer("/asset/generator").and_then(Value::as_str).map(str::to_owned),
        extensions_used: texts("extensionsUsed"),
        extensions_required: texts("extensionsRequired"),
        materials: materials.collect(),
    })
}

/// A reference of a material: its JSON pointer inside the material, and the texture.
type Slot = (String, usize);

/// Returns the references to textures, by material.
fn slots(root: &Value) -> BTreeMap<usize, Vec<Slot>> {
    let mut slots: BTreeMap<usize, Vec<Slot>> = BTreeMap::new();
    for (pointer, texture) in references(root) {
        let Some((material, slot)) = pointer.strip_prefix("/materials/").and_then(|rest| rest.split_once('/')) else {
            continue;
        };
        let Ok(material) = material.parse() else { continue };
        slots.entry(material).or_default().push((slot.to_owned(), texture));
    }
    slots
}

fn material_facts(
    index: usize,
    material: &Value,
    slots: Option<Vec<Slot>>,
    root: &Value,
    images: &mut Images<'_>,
) -> MaterialFacts {
    let mut errors = Vec::new();
    let pyramid = material.get("extensions").and_then(|e| e.get(EXTENSION)).cloned();
    if let Some(Err(reason)) = pyramid.as_ref().map(RoughnessPyramid::read) {
        errors.push(format!("{EXTENSION}: expected what its schema describes, found: {reason}"));
    }
    let count = root.get("textures").and_then(Value::as_array).map_or(0, Vec::len);
    let slots = slots.into_iter().flatten().map(|(slot, texture)| {
        if texture >= count {
            errors.push(format!("{slot}: expected an index below {count}, found {texture}"));
        }
        SlotFacts { slot, texture, images: images.of_texture(texture) }
    });
    let slots = slots.collect();
    MaterialFacts {
        name: material.get("name").and_then(Value::as_str).map_or_else(|| format!("material {index}"), str::to_owned),
        roughness_factor: material
            .pointer("/pbrMetallicRoughness/roughnessFactor")
            .and_then(Value::as_f64)
            .unwrap_or(1.0),
        slots,
        pyramid,
        errors,
    }
}

/// The images of a document. Each image is read once, however many materials use it.
struct Images<'a> {
    root: &'a Value,
    referenced: &'a ReferencedFiles<'a>,
    known: BTreeMap<usize, ImageFacts>,
}

impl Images<'_> {
    /// Returns the facts of every image that a texture names.
    fn of_texture(&mut self, texture: usize) -> Vec<ImageFacts> {
        let root = self.root;
        let Some(texture) = root.pointer(&format!("/textures/{texture}")) else { return Vec::new() };
        let extensions = texture.get("extensions").and_then(Value::as_object).into_iter().flatten();
        let named = extensions.filter_map(|(name, e)| Some((name.as_str(), e.get("source")?)));
        let core = texture.get("source").map(|index| ("source", index));
        let all = core.into_iter().chain(named);
        all.filter_map(|(name, index)| Some((name, usize::try_from(index.as_u64()?).ok()?)))
            .map(|(named_by, image)| ImageFacts { named_by: named_by.to_owned(), ..self.facts(image) })
            .collect()
    }

    fn facts(&mut self, image: usize) -> ImageFacts {
        let (root, referenced) = (self.root, self.referenced);
        self.known.entry(image).or_insert_with(|| image_facts(image, root, referenced)).clone()
    }
}

fn image_facts(image: usize, root: &Value, referenced: &ReferencedFiles<'_>) -> ImageFacts {
    let mut facts =
        ImageFacts { named_by: String::new(), image, location: String::new(), picture: None, ktx2: None, error: None };
    let Some(location) = location(root, image) else {
        facts.error = Some(format!("expected images[{image}] with a uri or a bufferView, found none"));
        return facts;
    };
    let options = match &location {
        ImageLocation::Uri(uri) => {
            facts.location =
                if uri.len() > 256 { format!("{}...", uri.chars().take(32).collect::<String>()) } else { uri.clone() };
            let extension = uri.rsplit_once('.').map(|(_, e)| e.to_owned());
            DecodeOptions { extension, ..DecodeOptions::default() }
        }
        ImageLocation::BufferView(view) => {
            facts.location = format!("bufferViews[{view}]");
            DecodeOptions::default()
        }
    };
    let partial = match referenced.image(&location) {
        Ok(partial) => partial,
        Err(error) => {
            facts.error = Some(error.to_string());
            return facts;
        }
    };
    if partial.is_ktx2() {
        match inspect_texture(partial.as_ktx2()) {
            Ok(ktx2) => facts.ktx2 = Some(ktx2),
            Err(error) => facts.error = Some(error.to_string()),
        }
        return facts;
    }
    let bytes = partial.start();
    let format = FileFormat::detect(bytes, options.extension.as_deref());
    match decode(bytes, &options) {
        Ok(image) => {
            facts.picture = Some(PictureFacts {
                format: format.map(|f| f.to_string()).unwrap_or_default(),
                width: image.width,
                height: image.height,
                channels: image.channels,
                bits: image.samples.bits(),
            });
        }
        Err(error) => facts.error = Some(error.to_string()),
    }
    facts
}

/// Returns the location of image `image` of the document.
pub fn location(root: &Value, image: usize) -> Option<ImageLocation> {
    let image = root.pointer(&format!("/images/{image}"))?;
    match (image.get("uri").and_then(Value::as_str), image.get("bufferView").and_then(Value::as_u64)) {
        (Some(uri), _) => Some(ImageLocation::Uri(uri.to_owned())),
        (None, view) => Some(ImageLocation::BufferView(usize::try_from(view?).ok()?)),
    }
}
