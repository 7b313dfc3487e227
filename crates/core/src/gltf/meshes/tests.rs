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
fn compression_is_found_on_primitives_and_on_the_buffer_views_that_they_read() {
    let meshopt = json!({ "extensions": { "EXT_meshopt_compression": { "buffer": 0 } } });
    let root = json!({
        "meshes": [{ "primitives": [
            { "attributes": { "POSITION": 0 }, "material": 0 },
            { "attributes": { "POSITION": 0 }, "indices": 1, "material": 1 },
            { "attributes": { "POSITION": 2 }, "material": 2, "extensions": { "KHR_draco_mesh_compression": {} } },
            { "attributes": { "POSITION": 7 }, "material": 3 },
        ] }],
        "accessors": [{ "bufferView": 0 }, { "bufferView": 1 }, {}],
        "bufferViews": [{}, meshopt],
    });
    let meshes = Meshes::of(&root);
    let found = [0, 1, 2, 3, 4].map(|material| meshes.compression(material));
    assert_eq!(found, [None, Some("EXT_meshopt_compression"), Some("KHR_draco_mesh_compression"), None, None]);
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
