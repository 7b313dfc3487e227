//! A build script for a game or viewer in Rust: bakes `assets/` into `OUT_DIR`, and again only if an input changes.
//!
//! To use it, copy this file to `build.rs` of your package, add `roughcast` with `default-features = false` to its
//! `[build-dependencies]`, and read the outputs with `include_bytes!(concat!(env!("OUT_DIR"), "/helmet.gltf"))` or from
//! `env!("OUT_DIR")`. Set `opt-level = 3` in `[profile.dev.build-override]` and `[profile.release.build-override]`:
//! without optimisation the encoder is slow and overflows the stacks of its threads.
//!
//! To try it with a folder `assets`: `CARGO_MANIFEST_DIR=. OUT_DIR=out cargo run --release --example build_script`.

use std::env::var_os;
use std::error::Error;
use std::fs;
use std::path::{Component, Path, PathBuf};

use roughcast::{Settings, bake_asset};

fn main() -> Result<(), Box<dyn Error>> {
    let assets = PathBuf::from(var_os("CARGO_MANIFEST_DIR").ok_or("Cargo sets CARGO_MANIFEST_DIR")?).join("assets");
    let output = PathBuf::from(var_os("OUT_DIR").ok_or("Cargo sets OUT_DIR")?);
    // Cargo runs the script again if assets are added or removed.
    println!("cargo::rerun-if-changed={}", assets.display());
    let mut sources: Vec<PathBuf> =
        fs::read_dir(&assets)?.map(|entry| Ok(entry?.path())).collect::<Result<_, std::io::Error>>()?;
    sources.retain(|path| path.extension().is_some_and(|e| e == "gltf" || e == "glb"));
    sources.sort();
    // Every file that the bake reads is an input of the build.
    let read = |path: &Path| {
        let path = assets.join(path);
        println!("cargo::rerun-if-changed={}", path.display());
        fs::read(path)
    };
    let settings = Settings::default();
    for source in sources {
        let name = PathBuf::from(source.file_name().ok_or("expected a file name")?);
        let stem = name.file_stem().and_then(|stem| stem.to_str()).ok_or("expected a file name in UTF-8")?;
        let baked = bake_asset(stem, &read(&name)?, &read, &settings)?;
        write(&output, &name.with_extension(baked.container.extension()), &baked.document)?;
        for file in &baked.files {
            write(&output, &file.path, &file.bytes)?;
        }
        for path in &baked.copies {
            write(&output, path, &read(path)?)?;
        }
    }
    Ok(())
}

/// Writes a file below `folder`. A document may name files outside its own folder, which this refuses to write.
fn write(folder: &Path, path: &Path, bytes: &[u8]) -> Result<(), Box<dyn Error>> {
    if !path.components().all(|part| matches!(part, Component::Normal(_))) {
        return Err(format!("{}: expected a path below the folder of the assets", path.display()).into());
    }
    let path = folder.join(path);
    fs::create_dir_all(path.parent().unwrap_or(folder))?;
    Ok(fs::write(path, bytes)?)
}
