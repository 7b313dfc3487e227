//! Which variant of an asset a document is, as `plugins/three/page/variants.js` decides it.

use crate::bake::DocumentProvenance;
use crate::gltf::document::Document;
use crate::gltf::json::JsonError;
use crate::gltf::roughness_pyramid::EXTENSION;

/// A variant of an asset. The order is that in which the page shows variants.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Variant {
    /// The asset before a bake.
    Original,
    /// A bake in the profile `portable`.
    Portable,
    /// A bake in the profile `pyramid`, or in both profiles.
    Pyramid,
}

impl Variant {
    /// Returns the variant that `document` is. Bakes record their provenance, and the pyramid profile has an extension.
    ///
    /// # Errors
    /// [`JsonError`] where the members that show it are not what glTF demands.
    pub fn of(document: &Document) -> Result<Self, JsonError> {
        let json = document.json();
        let used: Vec<String> = json.read("/extensionsUsed")?.unwrap_or_default();
        Ok(if used.iter().any(|name| name == EXTENSION) {
            Self::Pyramid
        } else if json.value(DocumentProvenance::POINTER)?.is_some() {
            Self::Portable
        } else {
            Self::Original
        })
    }

    /// Returns the name by which the page knows the variant.
    pub fn name(self) -> &'static str {
        match self {
            Self::Original => "original",
            Self::Portable => "portable",
            Self::Pyramid => "pyramid",
        }
    }

    /// Returns the title that the page shows.
    pub fn title(self) -> &'static str {
        match self {
            Self::Original => "Plain mips",
            Self::Portable => "Portable bake",
            Self::Pyramid => "Pyramid bake",
        }
    }
}
