//! Times a bake in memory of a document with one normal map and one roughness map, the decoding of its images, and a
//! copy of as many bytes: `cargo bench --bench whole`.
//!
//! Items are texels of level 0 of one map.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use roughcast::bake::{Source, bake_asset};
use roughcast::decode::decode;
use roughcast::gltf::document::Document;
use roughcast::image::DecodeOptions;
use roughcast::settings::{Form, Model, Settings};

mod common;

fn main() {
    divan::main();
}

/// Writes the asset and returns its files.
fn files() -> BTreeMap<PathBuf, Vec<u8>> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    common::asset::write(folder.path(), common::size(), 1).expect("a folder that takes files");
    let entries = fs::read_dir(folder.path()).expect("the folder").map(|entry| entry.expect("a file").path());
    entries.map(|path| (PathBuf::from(path.file_name().expect("a name")), fs::read(&path).expect("a file"))).collect()
}

fn whole(bencher: Bencher, form: Form, model: Model) {
    let files = files();
    let document = Document::parse(&files[&PathBuf::from("asset.gltf")]).expect("a document");
    let read = |path: &std::path::Path| Ok(files[path].clone());
    let source = Source::new("asset", &document, &read);
    let settings = Settings::default().with_gltf(form).with_model(model);
    let texels = common::size() * common::size();
    bencher.counter(ItemsCount::new(texels)).bench(|| bake_asset(black_box(&source), &settings, &|_| ()).map(drop));
}

/// Copies as many bytes as a bake reads and writes: two RGB images, and two textures with all levels of one byte a
/// texel before zstd.
#[divan::bench(sample_count = 20)]
fn copy(bencher: Bencher) {
    let texels = common::size() * common::size();
    common::bench_copy(bencher, 6 * texels, 2 * texels / 3 * 4);
}

/// Decodes the two PNGs, one after the other.
#[divan::bench(sample_count = 5)]
fn decoding_alone(bencher: Bencher) {
    let files = files();
    let texels = common::size() * common::size();
    bencher.counter(ItemsCount::new(texels)).bench(|| {
        let images = ["normal0.png", "surface0.png"].map(|name| &files[&PathBuf::from(name)]);
        images.map(|file| decode(black_box(file), &DecodeOptions::default()).map(drop))
    });
}

/// Bakes two textures of full size, without PNGs.
#[divan::bench(sample_count = 5)]
fn two_textures(bencher: Bencher) {
    whole(bencher, Form::Strict, Model::Isotropic);
}

/// Bakes the smallest model within the error bound, and PNGs.
#[divan::bench(sample_count = 5)]
fn with_png_copies(bencher: Bencher) {
    whole(bencher, Form::Fallback, Model::Auto);
}
