//! Attacks: damaged images, textures, documents and settings, forged cache entries, a full disk. Whatever comes in, the tool answers
//! with a result or an error, in bounded time, and touches nothing that is not its own.
//!
//! A run takes about a minute. `ROUGHCAST_ATTACK_ROUNDS=100 cargo test --release --test attack` makes a hundred times as many cases. A
//! failure names the seed of its case and keeps the case in a file; put that file into `tests/attack/found/<entry>`, where
//! every later run tries it first.

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

use harness::attack;

#[test]
fn damaged_documents() {
    attack("document", entries::document, &inputs::documents(), mutate::document);
}

#[test]
fn damaged_images() {
    attack("image", entries::image, &inputs::images(), mutate::image);
}

#[test]
fn damaged_textures() {
    attack("texture", entries::texture, &inputs::textures(), mutate::texture);
}

#[test]
fn damaged_settings() {
    let seeds = [include_bytes!("../../src/project/template.toml").to_vec(), inputs::CONFIGURATION.into()];
    attack("configuration", entries::configuration, &seeds, mutate::bytes);
}
