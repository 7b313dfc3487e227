//! Measures a bake of many assets that are all in the cache.
//!
//! `cargo run --release -p studies --bin no_op -- 1000` bakes 1000 assets twice, with PNG copies. It prints the time of
//! the second run, and the time of reading and hashing the same files one after the other. A second number makes each
//! image that many KiB longer.

use std::error::Error;
use std::fs;
use std::path::Path;
use std::time::Instant;

use clap::Parser;
use roughcast::cli::{Cli, Outcome, run};
use walkdir::WalkDir;

fn main() -> Result<(), Box<dyn Error>> {
    let mut numbers = std::env::args().skip(1).map(|n| n.parse::<usize>());
    let (count, padding) = (numbers.next().unwrap_or(Ok(1000))?, numbers.next().unwrap_or(Ok(0))?);
    let folder = tempfile::tempdir()?;
    let (assets, baked, cache) =
        (folder.path().join("assets"), folder.path().join("baked"), folder.path().join("cache"));
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/brushed");
    for index in 0..count {
        let asset = assets.join(format!("{index:05}"));
        fs::create_dir_all(&asset)?;
        for file in fs::read_dir(&fixture)? {
            let file = file?;
            let mut bytes = fs::read(file.path())?;
            if file.path().extension().is_some_and(|e| e == "png") {
                // Bytes behind the end of a PNG are not read, so the images differ and their bakes are equal.
                bytes.extend(index.to_le_bytes());
                bytes.resize(bytes.len() + 1024 * padding, 0);
            }
            fs::write(asset.join(file.file_name()), bytes)?;
        }
    }
    let bake = || -> Result<f64, Box<dyn Error>> {
        let words = ["roughcast".as_ref(), "bake".as_ref(), assets.as_os_str(), "-o".as_ref(), baked.as_os_str()];
        let cli = Cli::try_parse_from(words.into_iter().chain([
            "--cache".as_ref(),
            cache.as_os_str(),
            "-q".as_ref(),
            "--gltf=fallback".as_ref(),
        ]))?;
        let start = Instant::now();
        let (mut out, mut err) = (Vec::new(), Vec::new());
        match run(cli, &mut out, &mut err) {
            Outcome::Done => Ok(start.elapsed().as_secs_f64()),
            _ => Err(String::from_utf8_lossy(&err).into()),
        }
    };
    let first = bake()?;
    let (sources, outputs) = (best(|| hash_all(&assets))?, best(|| hash_all(&baked))?);
    let again = best(bake)?;
    println!("{count} assets: baked in {first:.2} s, nothing to do in {again:.3} s");
    println!("hashing the sources: {sources:.3} s, ratio {:.2}", again / sources);
    println!("hashing sources and outputs: {:.3} s, ratio {:.2}", sources + outputs, again / (sources + outputs));
    Ok(())
}

/// Returns the shortest of three times.
fn best(measure: impl Fn() -> Result<f64, Box<dyn Error>>) -> Result<f64, Box<dyn Error>> {
    (0..3).try_fold(f64::INFINITY, |least, _| Ok(least.min(measure()?)))
}

/// Returns the seconds of reading and hashing every file below `folder`.
fn hash_all(folder: &Path) -> Result<f64, Box<dyn Error>> {
    let start = Instant::now();
    let mut digests = Vec::new();
    for entry in WalkDir::new(folder) {
        let entry = entry?;
        if entry.file_type().is_file() {
            digests.push(blake3::hash(&fs::read(entry.path())?));
        }
    }
    std::hint::black_box(digests);
    Ok(start.elapsed().as_secs_f64())
}
