//! The primitives of a document by the materials that they show.

use std::collections::hash_map::Entry;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::atomic::AtomicUsize;

use serde_json::Value;

use super::scene::moving_coordinates;

/// Most triangles that are visited for one document, all together: accessors may repeat bytes and materials may share
/// primitives, so that a small file can name many.
const MAX_TRIANGLES: usize = 1 << 29;

/// A primitive that shows a material.
#[derive(Debug)]
pub struct Primitive<'r> {
    /// The primitive.
    pub value: &'r Value,
    /// Index into `meshes`.
    pub mesh: usize,
    /// How many primitives of the mesh draw the same triangles with the material. They are visited once.
    pub times: u32,
}

/// What tells the triangles of a primitive from others': mesh, `attributes`, `indices` and `mode`.
type Triangles = (usize, String);

/// The primitives of a document, looked up once for all materials.
#[derive(Debug)]
pub struct Meshes<'r> {
    /// The document.
    pub root: &'r Value,
    /// For each material the primitives that show it.
    users: BTreeMap<usize, Vec<Primitive<'r>>>,
    /// Materials whose texture coordinates move.
    moving: BTreeSet<usize>,
    /// How many triangles may still be visited.
    pub(super) left: AtomicUsize,
}

impl<'r> Meshes<'r> {
    /// Looks up the primitives of `root`, the document's JSON.
    pub fn of(root: &'r Value) -> Self {
        let mut users: BTreeMap<usize, Vec<Primitive<'_>>> = BTreeMap::new();
        let mut places: HashMap<(usize, Triangles), usize> = HashMap::new();
        let meshes = root.get("meshes").and_then(Value::as_array);
        for (mesh, value) in meshes.into_iter().flatten().enumerate() {
            let primitives = value.get("primitives").and_then(Value::as_array);
            for value in primitives.into_iter().flatten() {
                let parts = ["attributes", "indices", "mode"].map(|part| value.get(part));
                let triangles = format!("{parts:?}");
                for material in materials(value) {
                    let users = users.entry(material).or_default();
                    match places.entry((material, (mesh, triangles.clone()))) {
                        Entry::Occupied(place) => users[*place.get()].times += 1,
                        Entry::Vacant(place) => {
                            place.insert(users.len());
                            users.push(Primitive { value, mesh, times: 1 });
                        }
                    }
                }
            }
        }
        Self { root, users, moving: moving_coordinates(root), left: AtomicUsize::new(MAX_TRIANGLES) }
    }

    /// The primitives that show material `material`.
    pub fn primitives(&self, material: usize) -> &[Primitive<'r>] {
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
        let found = |material| meshes.primitives(material).iter().map(|p| (p.mesh, p.times)).collect::<Vec<_>>();
        assert_eq!([found(0), found(1), found(2)], [vec![], vec![(0, 1), (1, 1)], vec![(1, 1)]]);
    }

    #[test]
    fn primitives_of_the_same_triangles_are_one() {
        let primitive = |indices: u64| json!({ "attributes": { "POSITION": 0 }, "indices": indices, "material": 0 });
        let primitives = json!([primitive(1), primitive(2), primitive(1)]);
        let root = json!({ "meshes": [{ "primitives": primitives }, { "primitives": [primitive(1)] }] });
        let meshes = Meshes::of(&root);
        let found: Vec<_> = meshes.primitives(0).iter().map(|p| (p.mesh, p.times)).collect();
        assert_eq!(found, [(0, 2), (0, 1), (1, 1)]);
    }
}
