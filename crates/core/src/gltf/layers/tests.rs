use super::*;

#[test]
fn every_layer_has_a_row_with_its_name() {
    for row in &LAYERS {
        assert_eq!(row.kind.row().kind, row.kind);
        assert_eq!(serde_json::to_value(row.kind).unwrap(), row.name);
    }
}

#[test]
fn roughness_texture_and_factor_are_members_of_one_object() {
    let object = |pointer: Pointer| pointer.rsplit_once('/').map(|(object, _)| object);
    for row in &LAYERS {
        assert_eq!(object(row.roughness_texture), object(row.roughness_factor), "{:?}", row.kind);
        assert!(object(row.roughness_texture).is_some());
        if let Some(extension) = row.extension {
            assert_eq!(object(row.roughness_texture), Some(format!("extensions/{extension}").as_str()));
        }
        for part in row.anisotropy.iter().flat_map(|a| [a.texture, a.strength, a.rotation]) {
            assert_eq!(object(part), row.anisotropy.as_ref().map(|a| a.object), "{part}");
        }
        if let Some(row) = &row.reflectance {
            for part in [row.base_colour_texture, row.base_colour_factor, row.metallic_factor] {
                assert_eq!(object(part), Some(row.object), "{part}");
            }
            for part in [row.specular_texture, row.specular_factor] {
                assert_eq!(object(part), Some(row.specular), "{part}");
            }
            for part in [row.specular_colour_texture, row.specular_colour_factor] {
                assert_eq!(object(part), Some(row.specular), "{part}");
            }
        }
    }
}
