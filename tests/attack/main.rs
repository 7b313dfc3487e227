//! Attacks: damaged images, textures, documents and settings, forged cache entries, and a full disk. For every input
//! the tool returns a result or an error in bounded time, and writes only its own files.
//!
//! A run takes about a minute. `ROUGHCAST_ATTACK_ROUNDS=100 cargo test --release --test attack` runs a hundred times as
//! many cases. A failure names the seed of its case and writes the case to a file. Move that file to
//! `tests/attack/found/<entry>`, so that every later run tries it first.

mod cache;
#[cfg(target_os = "linux")]
mod disk;
#[path = "../fuzz/entries.rs"]
mod entries;
mod harness;
mod inputs;
mod mutate;
#[path = "../common/random.rs"]
mod random;
#[path = "../common/skip.rs"]
mod skip;

use harness::attack;

#[test]
fn survives_damaged_documents() {
    attack("document", entries::document, &inputs::documents(), mutate::document);
}

#[test]
fn survives_damaged_images() {
    attack("image", entries::image, &inputs::images(), mutate::image);
}

#[test]
fn survives_damaged_textures() {
    attack("texture", entries::texture, &inputs::textures(), mutate::texture);
}

#[test]
fn survives_damaged_settings() {
    let seeds =
        [include_bytes!("../../crates/pipeline/src/project/template.toml").to_vec(), inputs::CONFIGURATION.into()];
    attack("configuration", entries::configuration, &seeds, mutate::bytes);
}
