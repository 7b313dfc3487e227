//! What a command reads besides what its arguments name.

use std::path::Path;

use serde_json::Value;

use crate::gltf::document::Document;
use crate::gltf::uri::relative_path;
use crate::output::Guard;

/// Keeps `guard` from letting anything be written over `document`, which was read from `path`, and over the files that its
/// images and buffers name.
pub fn protect(guard: &mut Guard, path: &Path, document: &Document) {
    guard.add_source(path);
    let folder = path.parent().unwrap_or(Path::new(""));
    for list in ["/images", "/buffers"] {
        // What is wrong with the document is told by whoever needs it.
        let list: Vec<Value> = document.json().read(list).ok().flatten().unwrap_or_default();
        let uris = list.iter().filter_map(|object| object.get("uri").and_then(Value::as_str));
        uris.filter_map(|uri| relative_path(uri).ok()).for_each(|file| guard.add_source(&folder.join(file)));
    }
}
