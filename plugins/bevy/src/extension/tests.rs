use super::*;
use serde_json::json;

fn definition() -> Value {
    json!({
        "formatVersion": 2,
        "offsetTexture": { "index": 1, "extensions": { "KHR_texture_transform": { "scale": [2, 3], "texCoord": 1 } } },
        "offsetChannels": 3,
        "offsetScale": [1, -2],
        "roughnessModel": "covarianceFactor",
        "roughnessTexture": { "index": 2 },
        "roughnessMin": [0, -0.5, 0],
        "roughnessMax": [0.5, 0.5, 0.25],
        "correctionFactor": 0.8,
        "frame": "unit",
    })
}

#[test]
fn reads_what_the_schema_allows() {
    let extension = Extension::read(&definition()).unwrap();
    assert_eq!(extension.roughness_range(), [Vec3::new(0.0, -0.5, 0.0), Vec3::new(0.5, 0.5, 0.25)]);
    assert_eq!(extension.offset_texture.channel(), 1);
    assert_eq!(extension.offset_texture.uv_transform() * Vec3::ONE, Vec3::new(2.0, 3.0, 1.0));
    assert!(extension.has_z());
    let smooth = json!({
        "formatVersion": 2,
        "offsetTexture": { "index": 0 }, "offsetChannels": 2, "offsetScale": [1, 1], "correctionFactor": 1,
        "frame": "mainDirection", "mainDirection": [0, 1, 0],
    });
    let smooth = Extension::read(&smooth).unwrap();
    assert_eq!((smooth.has_z(), smooth.roughness_range()), (false, [Vec3::ZERO; 2]));
}

#[test]
fn a_base_lobe_has_the_defaults_of_gltf() {
    let mut definition = definition();
    definition["baseLobe"] = json!({ "metallicRoughnessTexture": { "index": 5 } });
    let extension = Extension::read(&definition).unwrap();
    let indices: Vec<usize> = extension.textures().map(|info| info.index).collect();
    assert_eq!(indices, [1, 2, 5]);
    let lobe = extension.base_lobe.unwrap();
    assert_eq!((lobe.roughness_factor, lobe.anisotropy.strength), (1.0, 0.0));
}

#[test]
fn names_what_the_schema_does_not_allow() {
    let cases = [
        ("formatVersion", json!(null), "formatVersion: expected 2, found none"),
        ("formatVersion", json!(1), "formatVersion: expected 2, found 1"),
        ("offsetTexture", json!(null), "offsetTexture"),
        ("offsetScale", json!([1]), "length 1"),
        ("offsetChannels", json!(4), "offsetChannels: expected 2 or 3, found 4"),
        ("roughnessModel", json!("variance"), "unknown variant `variance`"),
        ("roughnessTexture", json!(null), "roughnessTexture with roughnessModel"),
        ("roughnessMax", json!([1, 1]), "roughnessMax: expected 3 number(s), found 2"),
        ("roughnessMin", json!(null), "roughnessMin: expected 3 number(s), found 0"),
        ("correctionFactor", json!(-1), "at least 0"),
        ("frame", json!("mainDirection"), "mainDirection"),
    ];
    for (name, value, expected) in cases {
        let mut definition = definition();
        if value.is_null() {
            definition.as_object_mut().unwrap().remove(name);
        } else {
            definition[name] = value;
        }
        let found = Extension::read(&definition).unwrap_err();
        assert!(found.contains(expected), "{name}: {found}");
    }
}
