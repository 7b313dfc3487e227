//! Old textures and images, their names, and their extensions after a rewrite.

use super::*;
use crate::gltf::material::Mapping;

fn file(name: &str) -> NewImage {
    NewImage::File(name.to_owned())
}

fn slot(pointer: &str) -> Slot {
    Slot { pointer: pointer.to_owned(), mapping: Mapping::default() }
}

/// Returns a texture of a KTX2 file and, in the fallback form, of a PNG.
fn texture(name: &str, has_png: bool, slots: &[&str]) -> NewTexture {
    NewTexture {
        name: name.to_owned(),
        ktx2: file(&format!("{name}.ktx2")),
        source: has_png.then(|| file(&format!("{name}.png"))),
        sampler: None,
        slots: slots.iter().map(|pointer| slot(pointer)).collect(),
    }
}

fn rewritten(root: &Value, textures: &[NewTexture]) -> (Value, Vec<usize>) {
    let mut json = Json::parse(root.to_string().as_bytes()).unwrap();
    let indices = add_textures(&mut json, textures).unwrap();
    (json.value("").unwrap().unwrap(), indices)
}

const NORMAL: &str = "/materials/0/normalTexture";
const ROUGH: &str = "/materials/0/pbrMetallicRoughness/metallicRoughnessTexture";

/// Returns a material with a surface texture 0 and a normal texture 1, whose images have names.
fn material() -> Value {
    json!({
        "materials": [{
            "normalTexture": { "index": 1 },
            "pbrMetallicRoughness": { "metallicRoughnessTexture": { "index": 0 } },
        }],
        "textures": [{ "source": 0, "name": "Surface" }, { "source": 1 }],
        "images": [{ "uri": "orm.png", "name": "orm" }, { "uri": "bumps.png", "name": "bumps" }],
    })
}

#[test]
fn every_image_keeps_its_own_name() {
    let (root, indices) =
        rewritten(&material(), &[texture("b.normal", true, &[NORMAL]), texture("o.roughness", true, &[ROUGH])]);
    assert_eq!(indices, [1, 0]);
    assert_eq!(
        root["images"],
        json!([
            { "uri": "o.roughness.ktx2", "name": "orm" },
            { "uri": "b.normal.ktx2", "name": "bumps" },
            { "name": "b.normal", "uri": "b.normal.png" },
            { "name": "o.roughness", "uri": "o.roughness.png" },
        ])
    );
    let basisu = |image: usize| json!({ "KHR_texture_basisu": { "source": image } });
    assert_eq!(
        root["textures"],
        json!([
            { "source": 3, "name": "Surface", "extensions": basisu(0) },
            { "source": 2, "extensions": basisu(1), "name": "b.normal" },
        ])
    );
}

#[test]
fn new_objects_have_names() {
    let mut root = material();
    root["materials"][0]["occlusionTexture"] = json!({ "index": 0 });
    let (root, indices) = rewritten(&root, &[texture("o.roughness", false, &[ROUGH])]);
    assert_eq!(indices, [2], "the old texture is still the occlusion");
    assert_eq!(root["textures"][2]["name"], "o.roughness");
    assert_eq!(root["images"][2], json!({ "name": "o.roughness", "uri": "o.roughness.ktx2" }));
}

#[test]
fn extensions_of_replaced_textures_are_not_declared() {
    let mut root = material();
    let webp = |image: usize| json!({ "EXT_texture_webp": { "source": image } });
    root["images"] = json!([{ "uri": "orm.webp" }, { "uri": "bumps.webp" }]);
    root["textures"] = json!([{ "extensions": webp(0) }, { "extensions": webp(1) }]);
    root["extensionsUsed"] = json!(["EXT_texture_webp", "KHR_lights_punctual"]);
    root["extensionsRequired"] = json!(["EXT_texture_webp"]);
    let normal = texture("n", true, &[NORMAL]);
    let (one, _) = rewritten(&root, std::slice::from_ref(&normal));
    assert_eq!(one["extensionsUsed"], json!(["EXT_texture_webp", "KHR_lights_punctual", "KHR_texture_basisu"]));
    assert_eq!(one["extensionsRequired"], json!(["EXT_texture_webp"]));
    let (all, _) = rewritten(&root, &[normal, texture("r", true, &[ROUGH])]);
    assert_eq!(all["extensionsUsed"], json!(["KHR_lights_punctual", "KHR_texture_basisu"]));
    assert_eq!(all.get("extensionsRequired"), None);
}

#[test]
fn basisu_is_required_only_if_a_texture_needs_it() {
    let mut root = material();
    let basisu = json!({ "extensions": { "KHR_texture_basisu": { "source": 1 } } });
    root["textures"] = json!([{ "source": 0 }, basisu]);
    root["extensionsUsed"] = json!(["KHR_texture_basisu"]);
    root["extensionsRequired"] = json!(["KHR_texture_basisu"]);
    let (fallback, _) = rewritten(&root, &[texture("n", true, &[NORMAL])]);
    assert_eq!(fallback.get("extensionsRequired"), None);
    assert_eq!(fallback["extensionsUsed"], json!(["KHR_texture_basisu"]));
    let (strict, _) = rewritten(&root, &[texture("n", false, &[NORMAL])]);
    assert_eq!(strict["extensionsRequired"], json!(["KHR_texture_basisu"]));
}

#[test]
fn unused_images_are_removed() {
    let mut root = material();
    root["images"] = json!([{ "uri": "bumps.webp" }, { "uri": "bumps.png" }, { "uri": "orm.png" }]);
    let webp = json!({ "EXT_texture_webp": { "source": 0 } });
    root["textures"] = json!([{ "source": 2 }, { "source": 1, "extensions": webp }]);
    let strict = texture("n", false, &[NORMAL]);
    let (known, _) = rewritten(&root, std::slice::from_ref(&strict));
    assert_eq!(known["images"].as_array().unwrap().len(), 2, "{known}");
    assert_eq!(known["images"][0]["uri"], "n.ktx2");
    assert_eq!(known["images"][known["textures"][0]["source"].as_u64().unwrap() as usize]["uri"], "orm.png");
    // An extension may refer to images in an unknown way.
    root["extensions"] = json!({ "EXT_lights_image_based": { "lights": [{ "specularImages": [[2]] }] } });
    let (unknown, _) = rewritten(&root, &[strict]);
    assert_eq!(unknown["images"][2]["uri"], "orm.png");
}

/// One image of several slots becomes several textures. No old object is left.
#[test]
fn textures_whose_references_all_move_are_overwritten() {
    let mut root = material();
    let second = "/materials/1/pbrMetallicRoughness/metallicRoughnessTexture";
    root["materials"]
        .as_array_mut()
        .unwrap()
        .push(json!({ "pbrMetallicRoughness": { "metallicRoughnessTexture": { "index": 0 } } }));
    let (root, indices) = rewritten(&root, &[texture("a", false, &[ROUGH]), texture("b", false, &[second])]);
    assert_eq!(indices, [0, 2]);
    assert!(!root["images"].to_string().contains("orm.png"), "{}", root["images"]);
    assert_eq!(root.pointer(&format!("{second}/index")), Some(&json!(2)));
}

/// Two old textures become one new texture. Both are overwritten, and each slot keeps its texture.
#[test]
fn textures_that_become_one_are_both_overwritten() {
    let mut root = material();
    let second = "/materials/1/normalTexture";
    root["materials"].as_array_mut().unwrap().push(json!({ "normalTexture": { "index": 2 } }));
    root["textures"].as_array_mut().unwrap().push(json!({ "source": 1, "name": "again" }));
    let (root, indices) = rewritten(&root, &[texture("n", false, &[NORMAL, second])]);
    assert_eq!(indices, [1]);
    assert_eq!(root.pointer(&format!("{second}/index")), Some(&json!(2)));
    assert_eq!(root["textures"][1]["extensions"], root["textures"][2]["extensions"]);
    assert!(!root.to_string().contains("bumps.png"), "{root}");
}
