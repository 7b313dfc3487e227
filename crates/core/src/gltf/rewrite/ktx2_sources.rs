//! Textures whose core `source` is a KTX2 image inside of a .glb.

use serde_json::{Value, json};

use super::BASISU;
use crate::gltf::extensions::declare;
use crate::gltf::json::{Json, JsonError};

/// Names KTX2 images in buffer views by `KHR_texture_basisu` instead of the core `source`, for which glTF allows only
/// PNG and JPEG. An image in a buffer view must tell its media type, so that readers refuse such a `source`. It comes
/// from a source document with KTX2 files as core `source`, which some engines load.
///
/// # Errors
/// [`JsonError`] if the document is not a valid glTF document.
pub fn name_ktx2_sources(json: &mut Json) -> Result<(), JsonError> {
    let root = json.value("")?.unwrap_or_default();
    let textures = root.get("textures").and_then(Value::as_array).into_iter().flatten();
    let mut is_any_named = false;
    for (index, texture) in textures.enumerate() {
        let Some(source) = texture.get("source").and_then(Value::as_u64) else { continue };
        let image = root.pointer(&format!("/images/{source}")).unwrap_or(&Value::Null);
        let is_embedded_ktx2 = image.get("bufferView").is_some() && image.get("mimeType") == Some(&json!("image/ktx2"));
        if is_embedded_ktx2 && texture.pointer(&format!("/extensions/{BASISU}")).is_none() {
            json.set(&format!("/textures/{index}/extensions/{BASISU}"), &json!({ "source": source }))?;
            json.remove(&format!("/textures/{index}/source"))?;
            is_any_named = true;
        }
    }
    if is_any_named { declare(json, BASISU, true) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(root: &Value) -> Value {
        let mut json = Json::parse(root.to_string().as_bytes()).unwrap();
        name_ktx2_sources(&mut json).unwrap();
        json.value("").unwrap().unwrap()
    }

    #[test]
    fn only_embedded_ktx2_images_move_to_the_extension() {
        let root = json!({
            "textures": [
                { "source": 0, "sampler": 1 },
                { "source": 1 },
                { "source": 2 },
                { "source": 1, "extensions": { "KHR_texture_basisu": { "source": 0 } } },
            ],
            "images": [
                { "bufferView": 0, "mimeType": "image/ktx2" },
                { "bufferView": 1, "mimeType": "image/png" },
                { "uri": "a.ktx2" },
            ],
        });
        let found = named(&root);
        assert_eq!(
            found["textures"][0],
            json!({ "sampler": 1, "extensions": { "KHR_texture_basisu": { "source": 0 } } })
        );
        assert_eq!(found["textures"].as_array().unwrap()[1..], root["textures"].as_array().unwrap()[1..]);
        assert_eq!(found["extensionsUsed"], json!(["KHR_texture_basisu"]));
        assert_eq!(found["extensionsRequired"], json!(["KHR_texture_basisu"]));
    }

    #[test]
    fn a_document_without_such_textures_stays_as_it_is() {
        let root = json!({
            "textures": [{ "source": 0 }, { "source": 9 }, { "name": "empty" }],
            "images": [{ "uri": "a.ktx2", "mimeType": "image/ktx2" }],
        });
        assert_eq!(named(&root), root);
    }
}
