//! Measures the cost of checking many up-to-date outputs, with and without decoding them.
//!
//! `cargo run --release -p studies --bin check_cost -- 1000` bakes an asset with PNG copies, and copies the asset and
//! its source 1000 times. It prints the time of `check --source` and of `check --source --deep`, and the time of
//! reading and hashing the sources. A folder after the number is baked in place of a fixture.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Parser;
use roughcast::cli::{Cli, Outcome, run};
use walkdir::WalkDir;

/// The form of the baked assets, which has PNG copies.
const FORM: &str = "--gltf=fallback";

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let count: usize = arguments.next().map_or(Ok(1000), |n| n.parse())?;
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/brushed");
    let asset = arguments.next().map_or(fixture, PathBuf::from);
    let folder = tempfile::tempdir()?;
    let (source, baked) = (folder.path().join("source"), folder.path().join("baked"));
    let (sources, outputs) = (folder.path().join("sources"), folder.path().join("outputs"));
    copy(&asset, &source)?;
    roughcast(&["bake".as_ref(), &source, "-o".as_ref(), &baked, "-q".as_ref(), FORM.as_ref()])?;
    for index in 0..count {
        copy(&source, &sources.join(format!("{index:05}")))?;
        copy(&baked, &outputs.join(format!("{index:05}")))?;
    }
    let check: [&Path; 5] = ["check".as_ref(), &outputs, "--source".as_ref(), &sources, FORM.as_ref()];
    let hashing = best(|| hash_all(&sources))?;
    let heads = best(|| roughcast(&check))?;
    let deep = best(|| roughcast(&[&check[..], &["--deep".as_ref()]].concat()))?;
    println!("{count} assets: check {heads:.3} s, check --deep {deep:.3} s");
    println!("hashing the sources: {hashing:.3} s, ratios {:.2} and {:.2}", heads / hashing, deep / hashing);
    Ok(())
}

/// Returns the seconds that a command takes.
fn roughcast(words: &[&Path]) -> Result<f64, Box<dyn Error>> {
    let cli = Cli::try_parse_from([Path::new("roughcast")].iter().chain(words).map(|w| w.as_os_str()))?;
    let start = Instant::now();
    let (mut out, mut err) = (Vec::new(), Vec::new());
    match run(cli, &mut out, &mut err) {
        Outcome::Done => Ok(start.elapsed().as_secs_f64()),
        _ => Err(format!("{}{}", String::from_utf8_lossy(&out), String::from_utf8_lossy(&err)).into()),
    }
}

/// Returns the shortest of three times.
fn best(measure: impl Fn() -> Result<f64, Box<dyn Error>>) -> Result<f64, Box<dyn Error>> {
    (0..3).try_fold(f64::INFINITY, |least, _| Ok(least.min(measure()?)))
}

fn copy(from: &Path, to: &Path) -> Result<(), Box<dyn Error>> {
    for entry in WalkDir::new(from) {
        let entry = entry?;
        let place = to.join(entry.path().strip_prefix(from)?);
        if entry.file_type().is_dir() {
            fs::create_dir_all(place)?;
        } else {
            fs::copy(entry.path(), place)?;
        }
    }
    Ok(())
}

/// Returns the seconds of reading and hashing every file below `folder`.
fn hash_all(folder: &Path) -> Result<f64, Box<dyn Error>> {
    let start = Instant::now();
    for entry in WalkDir::new(folder) {
        let entry = entry?;
        if entry.file_type().is_file() {
            std::hint::black_box(blake3::hash(&fs::read(entry.path())?));
        }
    }
    Ok(start.elapsed().as_secs_f64())
}
