use serde_json::{Value, json};

use super::*;

fn recorded(texels: BumpTexels) -> Value {
    let map = MapProvenance { texels, layer: None, roughness_factor: Some(0.1), sources: Vec::new() };
    let range = RecordedRange::new(&Range { min: vec![-0.1], max: vec![0.1] });
    let bake = RecordedSettings::new(&Settings::default().with_scale_normals(false), Model::None);
    json!(MapSettings { bake, range: Some(range), scale: Some(0.5), map: map.recorded() })
}

#[test]
fn records_settings_range_and_texels_of_a_standalone_map() {
    let double = f64::from(0.1_f32);
    let normals = recorded(BumpTexels::Normals { layout: NormalLayout::Xy, is_green_down: true });
    let map = json!({ "channels": "xy", "greenDown": true, "layer": null, "roughnessFactor": double });
    assert_eq!(normals["map"].to_string(), map.to_string());
    assert_eq!(normals["range"].to_string(), json!({ "min": [-double], "max": [double] }).to_string());
    let names: Vec<_> = normals.as_object().expect("an object").keys().map(String::as_str).collect();
    assert_eq!(names[names.len() - 5..], ["heightScale", "asked", "range", "scale", "map"]);
    let heights = recorded(BumpTexels::Heights { scale: 0.1, wrap: [Wrap::Repeat, Wrap::Clamp] });
    let map = json!({
        "height": true, "heightScale": double, "wrap": ["repeat", "clamp"], "layer": null, "roughnessFactor": double
    });
    assert_eq!(heights["map"].to_string(), map.to_string());
}
