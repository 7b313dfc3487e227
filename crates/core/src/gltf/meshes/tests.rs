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
fn primitives_with_equal_triangles_are_one() {
    let primitive = |indices: u64| json!({ "attributes": { "POSITION": 0 }, "indices": indices, "material": 0 });
    let primitives = json!([primitive(1), primitive(2), primitive(1)]);
    let root = json!({ "meshes": [{ "primitives": primitives }, { "primitives": [primitive(1)] }] });
    let meshes = Meshes::of(&root);
    let found: Vec<_> = meshes.primitives(0).iter().map(|p| (p.mesh, p.times)).collect();
    assert_eq!(found, [(0, 2), (0, 1), (1, 1)]);
}
