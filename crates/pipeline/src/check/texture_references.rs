//! The images that the textures of a document name, and whether the document declares the extensions that name them.

use std::collections::{BTreeMap, BTreeSet};

use ::gltf::json::Root;
use serde_json::Value;

use super::findings::{Code, Findings};
use crate::gltf::layers::LAYERS;
use crate::gltf::roughness_pyramid::EXTENSION;

/// The extension by which textures name KTX2 images.
const BASISU: &str = "KHR_texture_basisu";

/// The images of all textures of a document.
pub struct Textures {
    list: Vec<TextureReferences>,
    /// For each image, the textures that name it by `source` or by the extension.
    users: BTreeMap<usize, Vec<usize>>,
}

/// The images of a texture, both within range.
#[derive(Clone, Copy, Debug, Default)]
pub struct TextureReferences {
    /// `source`.
    pub core: Option<usize>,
    /// `source` of `KHR_texture_basisu`.
    pub basisu: Option<usize>,
}

impl Textures {
    /// Reads the images of all textures, and reports invalid references.
    pub fn read(root: &Root, findings: &mut Findings) -> Self {
        let list = root.textures.iter().enumerate().map(|(index, texture)| {
            let place = format!("/textures/{index}");
            let extensions = texture.extensions.as_ref().map(|e| &e.others);
            let basisu = extensions.and_then(|e| e.get(BASISU)?.get("source"));
            let basisu = basisu.map(|index| index.as_u64().map_or(usize::MAX, to_index));
            // Crate `gltf` uses this index for "no source".
            let core = Some(texture.source.value()).filter(|i| *i != u32::MAX as usize);
            let has_other = || extensions.into_iter().flat_map(|e| e.values()).any(|e| e.get("source").is_some());
            if core.is_none() && !has_other() {
                findings.add(Code::NoImage, &place, "expected a texture with an image, found none; bake again");
            }
            let mut checked = |image: Option<usize>, member: &str| {
                let image = image?;
                let count = root.images.len();
                if image >= count {
                    let message = format!("expected an index below {count}, found {image}; bake again");
                    findings.add(Code::BadReference, format!("{place}/{member}"), message);
                }
                (image < count).then_some(image)
            };
            let core = checked(core, "source");
            TextureReferences { core, basisu: checked(basisu, "extensions/KHR_texture_basisu/source") }
        });
        let list: Vec<TextureReferences> = list.collect();
        let mut users: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (index, texture) in list.iter().enumerate() {
            for image in texture.core.into_iter().chain(texture.basisu.filter(|image| texture.core != Some(*image))) {
                users.entry(image).or_default().push(index);
            }
        }
        Self { list, users }
    }

    /// Returns the number of textures.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Returns the textures that name `image`, each with its index.
    pub fn users(&self, image: usize) -> impl Iterator<Item = (usize, TextureReferences)> {
        self.users.get(&image).into_iter().flatten().map(|texture| (*texture, self.get(*texture)))
    }

    /// Returns the images of a texture.
    pub fn get(&self, texture: usize) -> TextureReferences {
        self.list.get(texture).copied().unwrap_or_default()
    }

    /// Compares `extensionsUsed` and `extensionsRequired` with the extensions that the document uses.
    pub fn check_declarations(&self, root: &Root, value: &Value, findings: &mut Findings) {
        let materials = value.get("materials").and_then(Value::as_array).into_iter().flatten();
        let of_materials: BTreeSet<&str> = materials
            .filter_map(|m| m.get("extensions")?.as_object())
            .flat_map(|extensions| extensions.keys().map(String::as_str))
            .collect();
        let by_basisu = self.list.iter().any(|t| t.basisu.is_some());
        let is_used = |name: &str| of_materials.contains(name) || name == BASISU && by_basisu;
        let is_in = |list: &[String], name: &str| list.iter().any(|n| n == name);
        let of_layers = LAYERS.iter().filter_map(|row| Some(row.anisotropy.as_ref()?.extension));
        for name in [BASISU, EXTENSION].into_iter().chain(of_layers) {
            if is_used(name) && !is_in(&root.extensions_used, name) {
                let message =
                    format!("expected {name} in the list, since the document uses it, found it missing; bake again");
                findings.add(Code::NotDeclared, "/extensionsUsed", message);
            }
        }
        if is_in(&root.extensions_required, EXTENSION) {
            let message = format!(
                "expected {EXTENSION} in extensionsUsed only: engines without the plugin refuse the file; bake again"
            );
            findings.add(Code::VendorRequired, "/extensionsRequired", message);
        }
        let without_fallback = self.list.iter().position(|t| t.core.is_none() && t.basisu.is_some());
        match (without_fallback, is_in(&root.extensions_required, BASISU)) {
            (Some(texture), false) => {
                let message = format!(
                    "expected {BASISU} in extensionsRequired, since the texture has no other image, found it \
                     missing; bake again"
                );
                findings.add(Code::NotRequired, format!("/textures/{texture}"), message);
            }
            (None, true) => {
                let message = format!(
                    "expected {BASISU} in extensionsUsed only, since every texture has a fallback; bake again \
                     with --gltf strict, or remove the extension from extensionsRequired"
                );
                findings.add(Code::NeedlesslyRequired, "/extensionsRequired", message);
            }
            _ => {}
        }
    }
}

fn to_index(n: u64) -> usize {
    usize::try_from(n).unwrap_or(usize::MAX)
}
