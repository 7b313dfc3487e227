//! The textures of materials that a bake encodes and does not change: one table, and what their texels mean.

use serde_json::Value;

/// What the texels of a plain texture mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Meaning {
    /// Linear values without alpha.
    Linear,
    /// sRGB colours, and the use of their alpha.
    Colour(AlphaUse),
}

/// How a material uses the alpha of its base colour (glTF 2.0, section 3.9.4, "Alpha Coverage").
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlphaUse {
    /// Alpha is ignored.
    Opaque,
    /// Alpha blends.
    Blend,
    /// Texels whose alpha is below this number, above 0, are not drawn.
    Mask(f32),
}

/// A reference of a material to a plain texture.
#[derive(Clone, Debug, PartialEq)]
pub struct PlainTextureUse {
    /// JSON pointer of the `textureInfo` object.
    pub pointer: String,
    /// Index into `textures`.
    pub texture: usize,
    /// Index of the material.
    pub index: usize,
    /// Name of the material, or `material <index>`.
    pub material: String,
    /// What its texels mean.
    pub meaning: Meaning,
    /// Whether it is the base colour of the material.
    pub is_base_colour: bool,
}

/// The texels of a place of materials.
#[derive(Clone, Copy, PartialEq)]
enum Texels {
    Linear,
    Colour,
    /// Base colour, whose alpha counts by `alphaMode`.
    BaseColour,
}

/// Places of materials, relative to the material. Textures that use alpha for other values than coverage are not among
/// them, nor are vectors: `KHR_materials_specular`, `_sheen`, `_diffuse_transmission`, `_pbrSpecularGlossiness` and
/// `_anisotropy`.
const PLACES: [(&str, Texels); 10] = [
    ("pbrMetallicRoughness/baseColorTexture", Texels::BaseColour),
    ("pbrMetallicRoughness/metallicRoughnessTexture", Texels::Linear),
    ("occlusionTexture", Texels::Linear),
    ("emissiveTexture", Texels::Colour),
    ("extensions/KHR_materials_clearcoat/clearcoatTexture", Texels::Linear),
    ("extensions/KHR_materials_clearcoat/clearcoatRoughnessTexture", Texels::Linear),
    ("extensions/KHR_materials_transmission/transmissionTexture", Texels::Linear),
    ("extensions/KHR_materials_volume/thicknessTexture", Texels::Linear),
    ("extensions/KHR_materials_iridescence/iridescenceTexture", Texels::Linear),
    ("extensions/KHR_materials_iridescence/iridescenceThicknessTexture", Texels::Linear),
];

/// Returns the references of all materials of `root`, the document's JSON, to plain textures. What is not shaped as
/// glTF 2.0 says is no reference, and stays as it is.
pub fn plain_textures(root: &Value) -> Vec<PlainTextureUse> {
    let materials = root.get("materials").and_then(Value::as_array).into_iter().flatten().enumerate();
    let uses = materials.flat_map(|(index, material)| {
        PLACES.iter().filter_map(move |(place, texels)| {
            let info = material.pointer(&format!("/{place}"))?;
            let name = material.get("name").and_then(Value::as_str);
            Some(PlainTextureUse {
                pointer: format!("/materials/{index}/{place}"),
                index,
                texture: usize::try_from(info.get("index")?.as_u64()?).ok()?,
                material: name.map_or_else(|| format!("material {index}"), str::to_owned),
                meaning: match texels {
                    Texels::Linear => Meaning::Linear,
                    Texels::Colour => Meaning::Colour(AlphaUse::Opaque),
                    Texels::BaseColour => Meaning::Colour(alpha_use(material)),
                },
                is_base_colour: *texels == Texels::BaseColour,
            })
        })
    });
    uses.collect()
}

/// Returns how `material` uses the alpha of its base colour texture. The factor multiplies the alpha before it is
/// compared with the cutoff.
fn alpha_use(material: &Value) -> AlphaUse {
    let number = |pointer: &str, default: f64| material.pointer(pointer).and_then(Value::as_f64).unwrap_or(default);
    match material.get("alphaMode").and_then(Value::as_str) {
        Some("BLEND") => AlphaUse::Blend,
        Some("MASK") => {
            let cutoff = number("/alphaCutoff", 0.5) / number("/pbrMetallicRoughness/baseColorFactor/3", 1.0);
            // Every texel passes a cutoff of 0, and none passes one above 1.
            if cutoff > 0.0 && cutoff <= 1.0 { AlphaUse::Mask(cutoff as f32) } else { AlphaUse::Blend }
        }
        _ => AlphaUse::Opaque,
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn alpha_counts_by_the_mode_the_cutoff_and_the_factor() {
        let of = |material: Value| alpha_use(&material);
        assert_eq!(of(json!({})), AlphaUse::Opaque);
        assert_eq!(of(json!({ "alphaMode": "OPAQUE", "alphaCutoff": 0.1 })), AlphaUse::Opaque);
        assert_eq!(of(json!({ "alphaMode": "BLEND" })), AlphaUse::Blend);
        assert_eq!(of(json!({ "alphaMode": "MASK" })), AlphaUse::Mask(0.5));
        let factor = json!({ "baseColorFactor": [1, 1, 1, 0.5] });
        let masked = json!({ "alphaMode": "MASK", "alphaCutoff": 0.25, "pbrMetallicRoughness": factor });
        assert_eq!(of(masked), AlphaUse::Mask(0.5));
        assert_eq!(of(json!({ "alphaMode": "MASK", "alphaCutoff": 0 })), AlphaUse::Blend);
    }

    #[test]
    fn every_place_of_a_material_is_found_and_other_shapes_are_not() {
        let mut material = json!({ "occlusionTexture": { "index": "no" } });
        for (place, _) in PLACES {
            let mut at = &mut material;
            for member in place.split('/') {
                at = &mut at[member];
            }
            *at = json!({ "index": 3 });
        }
        let found = plain_textures(&json!({ "materials": [{ "emissiveTexture": { "index": -1 } }, material] }));
        assert_eq!(found.len(), PLACES.len());
        assert!(found.iter().all(|found| found.texture == 3 && found.material == "material 1"));
        assert_eq!(found[0].pointer, "/materials/1/pbrMetallicRoughness/baseColorTexture");
        assert_eq!(found[0].meaning, Meaning::Colour(AlphaUse::Opaque));
        assert!(found.iter().enumerate().all(|(n, found)| found.index == 1 && found.is_base_colour == (n == 0)));
        assert!(plain_textures(&json!({ "materials": [{ "occlusionTexture": 1 }] })).is_empty());
    }
}
