//! Inputs of the benches. `BENCH_SIZE` is the side of maps in texels: 4096 unless told.

#![allow(dead_code, reason = "no bench needs all of it")]

pub mod asset;
pub mod maps;

/// Side of the maps in texels.
pub fn size() -> usize {
    std::env::var("BENCH_SIZE").ok().and_then(|size| size.parse().ok()).unwrap_or(4096)
}

#[path = "../../examples/generate_fixtures/fixtures/asset.rs"]
mod gltf;
#[path = "../../examples/generate_fixtures/fixtures/mesh.rs"]
mod mesh;
#[path = "../../examples/generate_fixtures/fixtures/noise.rs"]
mod noise;
#[path = "../../examples/generate_fixtures/fixtures/picture.rs"]
mod picture;
