//! New textures, and the references to textures in a document.

use serde_json::Value;

use crate::gltf::json::escaped;
use crate::gltf::material::Mapping;

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
    /// The name of the texture and of its images, if they have none.
    pub name: String,
    /// The KTX2 file.
    pub ktx2: NewImage,
    /// The image of the core `source`. There is none in the strict form.
    pub source: Option<NewImage>,
    /// Index into `samplers`.
    pub sampler: Option<usize>,
    /// The references of materials to the texture.
    pub slots: Vec<Slot>,
}

/// A reference of a material to a texture.
#[derive(Clone, Debug, PartialEq)]
pub struct Slot {
    /// JSON pointer of the `textureInfo` object.
    pub pointer: String,
    /// Texture coordinates of a new slot.
    pub mapping: Mapping,
}

/// Returns pointers of all objects that may be a `textureInfo`, with the texture that each names. Every object with an
/// `index` counts, so that textures of unknown extensions are kept.
pub fn references(root: &Value) -> Vec<(String, usize)> {
    fn walk(value: &Value, pointer: &str, found: &mut Vec<(String, usize)>) {
        match value {
            Value::Object(members) => {
                if let Some(index) = members.get("index").and_then(Value::as_u64) {
                    found.push((pointer.to_owned(), usize::try_from(index).unwrap_or(usize::MAX)));
                }
                for (key, member) in members {
                    walk(member, &format!("{pointer}/{}", escaped(key)), found);
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
