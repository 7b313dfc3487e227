//! Inputs of the benches, and copies to compare them with. `BENCH_SIZE` is the side of maps in texels, 4096 by default.

#![allow(dead_code, reason = "no bench needs all of it")]

pub mod asset;
pub mod copy;
pub mod maps;

/// Returns the side of the maps in texels.
pub fn size() -> usize {
    std::env::var("BENCH_SIZE").ok().and_then(|size| size.parse().ok()).unwrap_or(4096)
}

/// Times a copy of as many bytes as a kernel reads and writes, into new memory.
pub fn bench_copy(bencher: divan::Bencher, read: usize, written: usize) {
    let source = vec![1; read];
    let copy = || copy::copied(divan::black_box(&source), vec![0; written]);
    bencher.counter(divan::counter::BytesCount::new(read + written)).bench(copy);
}

#[path = "../studies/generate_fixtures/fixtures/asset.rs"]
mod gltf;
#[path = "../studies/generate_fixtures/fixtures/mesh.rs"]
mod mesh;
#[path = "../studies/generate_fixtures/fixtures/noise.rs"]
mod noise;
#[path = "../studies/generate_fixtures/fixtures/picture.rs"]
mod picture;
