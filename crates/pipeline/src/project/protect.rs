//! Protection of the files that a document refers to.

use std::path::Path;

use serde_json::Value;

use crate::gltf::document::Document;
use crate::gltf::uri::relative_path;
use crate::output::Guard;

/// Registers `document`, which was read from `path`, and the files of its images and buffers as sources of `guard`, so
/// that nothing is written over them.
pub fn protect(guard: &mut Guard, path: &Path, document: &Document) {
    guard.add_source(path);
    let folder = path.parent().unwrap_or(Path::new(""));
    for list in ["/images", "/buffers"] {
        // A list that is malformed is reported by the reader that needs the list.
        let list: Vec<Value> = document.json().read(list).ok().flatten().unwrap_or_default();
        let uris = list.iter().filter_map(|object| object.get("uri").and_then(Value::as_str));
        uris.filter_map(|uri| relative_path(uri).ok()).for_each(|file| guard.add_source(&folder.join(file)));
    }
}
