//! A build script for a game or viewer in Rust: bakes `assets/` into `OUT_DIR`, and again only when an input changes.
//!
//! To use it, copy this file to `build.rs` of your package, add `roughcast` to its `[build-dependencies]` and read the
//! outputs with `include_bytes!(concat!(env!("OUT_DIR"), "/helmet.gltf"))` or from `env!("OUT_DIR")`. Here:
//! `CARGO_MANIFEST_DIR=. OUT_DIR=out cargo run --release --example build_script` with a folder `assets`.

use std::env::var_os;
use std::error::Error;
use std::fs;
use std::path::PathBuf;

use roughcast::output::Guard;
use roughcast::project::resolve;
use roughcast::run::{Job, MemoryBudget, finish, prepare};

fn main() -> Result<(), Box<dyn Error>> {
    let assets = PathBuf::from(var_os("CARGO_MANIFEST_DIR").ok_or("Cargo sets CARGO_MANIFEST_DIR")?).join("assets");
    let output = PathBuf::from(var_os("OUT_DIR").ok_or("Cargo sets OUT_DIR")?);
    // New and removed assets.
    println!("cargo::rerun-if-changed={}", assets.display());
    let mut sources: Vec<PathBuf> =
        fs::read_dir(&assets)?.map(|entry| Ok(entry?.path())).collect::<Result<_, std::io::Error>>()?;
    sources.retain(|path| path.extension().is_some_and(|e| e == "gltf" || e == "glb"));
    sources.sort();
    let settings = resolve(&[])?.values;
    let (mut guard, budget) = (Guard::inside(&output), MemoryBudget::new(1));
    for source in sources {
        let job = Job::new(&source, &output, &settings)?;
        for input in &job.inputs {
            println!("cargo::rerun-if-changed={}", input.path.display());
        }
        let prepared = prepare(&job, None, &budget, &|_| {});
        finish(&job, prepared, &mut guard, &mut |_| {})?;
    }
    Ok(())
}
