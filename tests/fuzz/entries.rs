//! Entry points for untrusted bytes. Each returns a result or an error within bounds of time and memory.
//!
//! `cargo +nightly fuzz run --fuzz-dir tests/fuzz <entry>` searches for bytes that break this promise. Cases that did
//! are in `tests/attack/found`, and `cargo test --test attack` runs them again.
#![allow(dead_code, reason = "each target has one entry")]

use std::io;
use std::path::Path;

use roughcast::bake::{Source, bake_asset};
use roughcast::check::{ReferencedFiles, Scope, check_document};
use roughcast::decode::decode;
use roughcast::gltf::document::Document;
use roughcast::image::DecodeOptions;
use roughcast::inspect::{extract, inspect_document, inspect_texture};
use roughcast::project::{Config, resolve};
use roughcast::settings::{Form, Model, Profile, Settings};

/// Limit of texels, so that a header with a false size cannot make a run slow.
const MAX_TEXELS: u64 = 1 << 12;

/// Checks, inspects and bakes a .gltf or .glb whose images are all one normal map of 8 x 8 texels. A baked document
/// must be readable.
pub fn document(bytes: &[u8]) {
    let read = |path: &Path| match path.extension().and_then(|e| e.to_str()) {
        Some("png") => Ok(include_bytes!("../../fixtures/maps/line_normal.png").to_vec()),
        Some("bin") => Ok(vec![0; 256]),
        _ => Err(io::Error::from(io::ErrorKind::NotFound)),
    };
    let _ = check_document("fuzzed.gltf", bytes, &read, &Scope { is_deep: true, ..Scope::default() });
    let Ok(document) = Document::parse(bytes) else { return };
    let source = Source::new("fuzzed", &document, &read);
    if let Ok(root) = document.json().value("") {
        let root = root.unwrap_or_default();
        let _ = inspect_document(&root, &ReferencedFiles::new(&document, &root, &read, true));
    }
    for (profile, model, form, glb) in [
        (Profile::Both, Model::Isotropic, Form::Fallback, false),
        (Profile::Portable, Model::Anisotropic, Form::Strict, true),
    ] {
        let settings = Settings::default().with_profile(profile).with_model(model);
        let settings = settings.with_gltf(form).with_glb(glb).with_max_texels(MAX_TEXELS);
        if let Ok(baked) = bake_asset(&source, &settings, &|_| ()) {
            Document::parse(&baked.document).expect("what is baked is a document");
        }
    }
}

/// Inspects, decodes and extracts a KTX2 file.
pub fn texture(bytes: &[u8]) {
    let _ = inspect_texture(bytes);
    let options = DecodeOptions { max_pixels: MAX_TEXELS, layer: None, extension: Some("ktx2".to_owned()) };
    if decode(bytes, &options).is_ok() {
        let _ = extract(bytes);
    }
}

/// Parses and resolves a `roughcast.toml`.
pub fn configuration(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if let Ok(config) = Config::parse(text, Path::new("assets/roughcast.toml")) {
        let _ = resolve(&config.sources(Path::new("props/helmet.gltf")));
    }
}

/// Decodes an image. The first byte selects the file extension.
pub fn image(bytes: &[u8]) {
    const NAMES: [&str; 9] = ["png", "jpg", "tif", "tga", "webp", "hdr", "exr", "ktx2", "?"];
    let Some((first, bytes)) = bytes.split_first() else { return };
    let name = NAMES[usize::from(*first) % NAMES.len()];
    let options = DecodeOptions { max_pixels: MAX_TEXELS, layer: None, extension: Some(name.to_owned()) };
    if let Ok(image) = decode(bytes, &options) {
        assert!(u64::from(image.width) * u64::from(image.height) <= MAX_TEXELS);
    }
}
