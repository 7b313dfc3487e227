//! The extensions of a document: their names, and whether objects of the document may be renumbered.

use std::collections::BTreeSet;

use serde_json::Value;

use super::json::{Json, JsonError};
use super::roughness_pyramid::EXTENSION;

/// Extensions outside materials that refer to images only as `source` of a texture, and to buffer views only as
/// `bufferView`. Other extensions may refer to them in other ways, as `EXT_structural_metadata` does.
const KNOWN: [&str; 15] = [
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "KHR_xmp_json_ld",
    "MSFT_lod",
    "MSFT_texture_dds",
    EXTENSION,
];

/// Returns whether all extensions of `root` are known to refer to images and buffer views as the core of glTF does.
/// Images and buffer views can then be renumbered.
pub fn are_known(root: &Value) -> bool {
    let used = root.get("extensionsUsed").and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str);
    let is_known = |name: &str| name.starts_with("KHR_materials_") || KNOWN.contains(&name);
    names(root).into_iter().chain(used).all(is_known)
}

/// Returns the names of the extensions that objects of `root` have.
pub fn names(root: &Value) -> BTreeSet<&str> {
    fn walk<'v>(value: &'v Value, names: &mut BTreeSet<&'v str>) {
        match value {
            Value::Object(members) => {
                if let Some(Value::Object(extensions)) = members.get("extensions") {
                    names.extend(extensions.keys().map(String::as_str));
                }
                members.values().for_each(|member| walk(member, names));
            }
            Value::Array(elements) => elements.iter().for_each(|element| walk(element, names)),
            _ => {}
        }
    }
    let mut found = BTreeSet::new();
    walk(root, &mut found);
    found
}

/// Adds `name` to `extensionsUsed` and, if `required`, to `extensionsRequired`, unless the name is there.
///
/// # Errors
/// [`JsonError`] if a list is not an array.
pub fn declare(json: &mut Json, name: &str, required: bool) -> Result<(), JsonError> {
    let lists = [Some("/extensionsUsed"), required.then_some("/extensionsRequired")];
    for list in lists.into_iter().flatten() {
        let names: Vec<String> = json.read(list)?.unwrap_or_default();
        if !names.iter().any(|n| n == name) {
            json.push(list, name)?;
        }
    }
    Ok(())
}

/// Removes the names that `is_gone` accepts from the list at `list`. An empty list is removed too, since glTF allows
/// none.
///
/// # Errors
/// [`JsonError`] if the list is not an array of strings.
pub fn undeclare(json: &mut Json, list: &str, is_gone: impl Fn(&str) -> bool) -> Result<(), JsonError> {
    let names: Vec<String> = json.read(list)?.unwrap_or_default();
    if names.iter().any(|name| is_gone(name)) {
        json.retain(list, |index| !is_gone(&names[index]))?;
        if names.iter().all(|name| is_gone(name)) {
            json.remove(list)?;
        }
    }
    Ok(())
}
