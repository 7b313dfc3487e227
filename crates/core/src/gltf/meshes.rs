//! The primitives of a document, by the materials that they show.

use std::collections::hash_map::Entry;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::atomic::AtomicUsize;

use serde_json::Value;

use super::scene::moving_coordinates;

/// Most triangles that are visited for one document. Accessors may repeat bytes and materials may share primitives, so
/// a small file can name very many triangles.
const MAX_TRIANGLES: usize = 1 << 29;

/// Extensions that compress the triangles of a primitive or the data of a buffer view. The bake has no decoder for
/// them: the well-kept ones are in C++, those in Rust are first versions (`meshopt-rs` 0.1, `draco-oxide` alpha), and
/// few settings need triangles.
const COMPRESSIONS: [&str; 3] = ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"];

/// A primitive that shows a material.
#[derive(Debug)]
pub struct Primitive<'r> {
    /// The primitive.
    pub value: &'r Value,
    /// Index into `meshes`.
    pub mesh: usize,
    /// How many primitives of the mesh draw the same triangles with the material. These triangles are visited once.
    pub times: u32,
}

/// A key that distinguishes the triangles of primitives: mesh, and `attributes`, `indices` and `mode` as text.
type Triangles = (usize, String);

/// The primitives of a document, looked up once for all materials.
#[derive(Debug)]
pub struct Meshes<'r> {
    /// The document.
    pub root: &'r Value,
    /// The primitives that show each material.
    users: BTreeMap<usize, Vec<Primitive<'r>>>,
    /// Materials whose texture coordinates an animation changes.
    moving: BTreeSet<usize>,
    /// Number of triangles that may still be visited.
    pub(super) remaining: AtomicUsize,
}

impl<'r> Meshes<'r> {
    /// Finds the primitives of `root`, the document's JSON.
    pub fn of(root: &'r Value) -> Self {
        let mut users: BTreeMap<usize, Vec<Primitive<'_>>> = BTreeMap::new();
        let mut positions: HashMap<(usize, Triangles), usize> = HashMap::new();
        let meshes = root.get("meshes").and_then(Value::as_array);
        for (mesh, value) in meshes.into_iter().flatten().enumerate() {
            let primitives = value.get("primitives").and_then(Value::as_array);
            for value in primitives.into_iter().flatten() {
                let parts = ["attributes", "indices", "mode"].map(|part| value.get(part));
                let triangles = format!("{parts:?}");
                for material in materials(value) {
                    let users = users.entry(material).or_default();
                    match positions.entry((material, (mesh, triangles.clone()))) {
                        Entry::Occupied(position) => users[*position.get()].times += 1,
                        Entry::Vacant(position) => {
                            position.insert(users.len());
                            users.push(Primitive { value, mesh, times: 1 });
                        }
                    }
                }
            }
        }
        Self { root, users, moving: moving_coordinates(root), remaining: AtomicUsize::new(MAX_TRIANGLES) }
    }

    /// Returns the primitives that show material `material`.
    pub fn primitives(&self, material: usize) -> &[Primitive<'r>] {
        self.users.get(&material).map_or(&[], Vec::as_slice)
    }

    /// Returns the first extension that compresses a primitive which shows material `material`.
    pub fn compression(&self, material: usize) -> Option<&'static str> {
        self.primitives(material).iter().find_map(|primitive| compression(self.root, primitive.value))
    }

    /// Returns whether an animation changes the scale or the rotation of a texture transform of material `material`.
    pub fn has_moving_coordinates(&self, material: usize) -> bool {
        self.moving.contains(&material)
    }
}

/// Returns the materials with which a primitive is drawn, by itself or in one of its `KHR_materials_variants`.
fn materials(primitive: &Value) -> BTreeSet<usize> {
    let mappings = primitive.pointer("/extensions/KHR_materials_variants/mappings").and_then(Value::as_array);
    let drawn = mappings.into_iter().flatten().chain([primitive]);
    drawn.filter_map(|value| usize::try_from(value.get("material")?.as_u64()?).ok()).collect()
}

/// Returns the extension that compresses `primitive` itself or a buffer view that its accessors read.
fn compression(root: &Value, primitive: &Value) -> Option<&'static str> {
    let element = |array: &str, index: &Value| root.get(array)?.get(usize::try_from(index.as_u64()?).ok()?);
    let attributes = primitive.get("attributes").and_then(Value::as_object);
    let accessors = attributes.into_iter().flat_map(|attributes| attributes.values()).chain(primitive.get("indices"));
    let mut views =
        accessors.filter_map(|accessor| element("bufferViews", element("accessors", accessor)?.get("bufferView")?));
    let has = |value: &Value, name: &str| value.get("extensions").is_some_and(|e| e.get(name).is_some());
    let compresses = |value: &Value| COMPRESSIONS.into_iter().find(|name| has(value, name));
    compresses(primitive).or_else(|| views.find_map(compresses))
}

#[cfg(test)]
mod tests;
