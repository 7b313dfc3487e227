//! Where bytes of others come in: whatever they are, an error or an answer, within bounds of time and memory.
//!
//! `cargo +nightly fuzz run --fuzz-dir tests/fuzz <entry>` looks for bytes that break this; those that did are in `found`, and
//! `tests/hostile.rs` tries them again.
#![allow(dead_code, reason = "each target has one entry")]

use std::io;
use std::path::Path;

use roughcast::bake::{Source, bake};
use roughcast::check::{Referred, Scope, check_document};
use roughcast::decode::decode;
use roughcast::gltf::document::Document;
use roughcast::image::DecodeOptions;
use roughcast::inspect::{extract, inspect_document, inspect_texture};
use roughcast::project::{Config, resolve};
use roughcast::settings::{Model, Profile, Settings};

/// Few enough that a lying header cannot make a run slow.
const MAX_TEXELS: u64 = 1 << 12;

/// A .gltf or .glb, whose images are one normal map of 8x8 texels; what is baked from it can be read.
pub fn document(bytes: &[u8]) {
    let read = |path: &Path| match path.extension().and_then(|e| e.to_str()) {
        Some("png") => Ok(include_bytes!("../../fixtures/maps/line_normal.png").to_vec()),
        Some("bin") => Ok(vec![0; 256]),
        _ => Err(io::Error::from(io::ErrorKind::NotFound)),
    };
    let _ = check_document("fuzzed.gltf", bytes, &read, &Scope { is_deep: true, ..Scope::default() });
    let Ok(document) = Document::parse(bytes) else { return };
    let source = Source { stem: "fuzzed", document: &document, files: &read };
    if let Ok(root) = document.json().value("") {
        let root = root.unwrap_or_default();
        let _ = inspect_document(&root, &Referred::new(&document, &root, &read, true));
    }
    for (profile, model, glb) in
        [(Profile::Both, Model::Isotropic, false), (Profile::Portable, Model::Anisotropic, true)]
    {
        let settings = Settings { profile, model, glb, max_texels: MAX_TEXELS, ..Settings::default() };
        if let Ok(baked) = bake(&source, &settings, &|_| ()) {
            Document::parse(&baked.document).expect("what is baked is a document");
        }
    }
}

/// A KTX2 file.
pub fn texture(bytes: &[u8]) {
    let _ = inspect_texture(bytes);
    let options = DecodeOptions { max_pixels: MAX_TEXELS, layer: None, extension: Some("ktx2".to_owned()) };
    if decode(bytes, &options).is_ok() {
        let _ = extract(bytes);
    }
}

/// A `roughcast.toml`.
pub fn configuration(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if let Ok(config) = Config::parse(text, Path::new("assets/roughcast.toml")) {
        let _ = resolve(&config.layers(Path::new("props/helmet.gltf")));
    }
}

/// An image in any format: the first byte says by which name.
pub fn image(bytes: &[u8]) {
    const NAMES: [&str; 9] = ["png", "jpg", "tif", "tga", "webp", "hdr", "exr", "ktx2", "?"];
    let Some((first, bytes)) = bytes.split_first() else { return };
    let name = NAMES[usize::from(*first) % NAMES.len()];
    let options = DecodeOptions { max_pixels: MAX_TEXELS, layer: None, extension: Some(name.to_owned()) };
    if let Ok(image) = decode(bytes, &options) {
        assert!(u64::from(image.width) * u64::from(image.height) <= MAX_TEXELS);
    }
}
