//! The primitives of a document by the materials that they show.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::AtomicUsize;

use serde_json::Value;

use super::scene::moving_coordinates;

/// Most triangles that are visited for one document, all together: primitives may repeat accessors and materials may share
/// primitives, so that a small file can name many.
const MAX_TRIANGLES: usize = 1 << 30;

/// The primitives of a document, looked up once for all materials.
#[derive(Debug)]
pub struct Meshes<'r> {
    /// The document.
    pub root: &'r Value,
    /// For each material the primitives that show it, each with the index of its mesh.
    users: BTreeMap<usize, Vec<(usize, &'r Value)>>,
    /// Materials whose texture coordinates move.
    moving: BTreeSet<usize>,
    /// How many triangles may still be visited.
    pub(super) left: AtomicUsize,
}

impl<'r> Meshes<'r> {
    /// Looks up the primitives of `root`, the document's JSON.
    pub fn of(root: &'r Value) -> Self {
        let mut users: BTreeMap<usize, Vec<(usize, &Value)>> = BTreeMap::new();
        let meshes = root.get("meshes").and_then(Value::as_array);
        for (mesh, value) in meshes.into_iter().flatten().enumerate() {
            let primitives = value.get("primitives").and_then(Value::as_array);
            for primitive in primitives.into_iter().flatten() {
                for material in materials(primitive) {
                    users.entry(material).or_default().push((mesh, primitive));
                }
            }
        }
        Self { root, users, moving: moving_coordinates(root), left: AtomicUsize::new(MAX_TRIANGLES) }
    }

    /// The primitives that show material `material`, each with the index of its mesh.
    pub fn primitives(&self, material: usize) -> &[(usize, &'r Value)] {
        self.users.get(&material).map_or(&[], Vec::as_slice)
    }

    /// Whether an animation changes the scale or the turn of a texture transform of material `material`.
    pub fn has_moving_coordinates(&self, material: usize) -> bool {
        self.moving.contains(&material)
    }
}

/// The materials with which a primitive is drawn, by itself or in one of its `KHR_materials_variants`.
fn materials(primitive: &Value) -> BTreeSet<usize> {
    let mappings = primitive.pointer("/extensions/KHR_materials_variants/mappings").and_then(Value::as_array);
    let drawn = mappings.into_iter().flatten().chain([primitive]);
    drawn.filter_map(|value| usize::try_from(value.get("material")?.as_u64()?).ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn primitives_are_found_by_material_and_by_variant() {
        let variants = json!({ "KHR_materials_variants": { "mappings": [{ "material": 2 }, { "material": 1 }] } });
        let root = json!({ "meshes": [
            { "primitives": [{ "material": 1 }, { "mode": 4 }] },
            { "primitives": [{ "material": 1, "extensions": variants }] },
        ] });
        let meshes = Meshes::of(&root);
        let found = |material| meshes.primitives(material).iter().map(|(mesh, _)| *mesh).collect::<Vec<_>>();
        assert_eq!([found(0), found(1), found(2)], [vec![], vec![0, 1], vec![1]]);
    }
}
