//! Prints what `--rdo` saves on real maps and what it costs, as markdown.
//!
//! `cargo run --release -p studies --bin rdo [DB] [fast|best]` uses 0.5 dB and `fast` by default. It reads
//! `../shared/data`, else `fixtures`. It encodes and compresses level 0 of each normal map and of each map with
//! roughness as `bake` does.

use std::error::Error;
use std::path::{Path, PathBuf};

use roughcast::codec::uastc::{Effort, Metric};
use roughcast::codec::{ORM, PayloadFormat, Texels, encode, lower_rate};
use roughcast::decode::decode;
use roughcast::image::DecodeOptions;
use roughcast::ktx2::{Ktx2, Ktx2Writer, StoredLevel};

/// Parts of names of normal maps and of maps with roughness.
const NORMALS: [&str; 3] = ["normal", "_nor_", "Normal"];
const SURFACES: [&str; 3] = ["_rough", "_arm_", "OcclusionRoughMetal"];

fn main() -> Result<(), Box<dyn Error>> {
    let loss = std::env::args().nth(1).map_or(Ok(0.5), |n| n.parse::<f64>())?;
    let effort = if std::env::args().nth(2).as_deref() == Some("best") { Effort::Best } else { Effort::Fast };
    let shared = Path::new("../shared/data");
    let mut files = Vec::new();
    collect(if shared.is_dir() { shared } else { Path::new("fixtures") }, &mut files)?;
    files.sort();
    println!("| map | bytes | with `--rdo {loss}` | saved | RGB loss |");
    println!("|---|---|---|---|---|");
    let (mut sums, mut largest) = ([0, 0], 0.0f64);
    for file in files {
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let has = |parts: &[&str]| parts.iter().any(|part| name.contains(part));
        let metric = match (has(&NORMALS), has(&SURFACES)) {
            (true, _) => Metric::Direction,
            (_, true) => ORM,
            _ => continue,
        };
        let image = decode(&std::fs::read(&file)?, &DecodeOptions::default())?;
        let row = |y: u32, out: &mut [[f32; 4]]| {
            for (x, texel) in out.iter_mut().enumerate() {
                *texel = [0, 1, 2, 3].map(|c| image.sample(x as u32, y, c).unwrap_or(1.0));
            }
        };
        let texels = Texels { width: image.width, height: image.height, row: &row, lobes: None };
        let before = encode(&texels, PayloadFormat::UastcRgb, metric, effort)?;
        let mut after = before.clone();
        lower_rate(&mut after, &texels, metric, loss)?;
        let [(bytes, error), (fewer, more)] = [measured(before, &texels, effort)?, measured(after, &texels, effort)?];
        let lost = if error > 0.0 { 10.0 * (more / error).log10() } else { 0.0 };
        println!("| {name} | {bytes} | {fewer} | {:.1} % | {lost:.2} dB |", saved(bytes, fewer));
        sums = [sums[0] + bytes, sums[1] + fewer];
        largest = largest.max(lost);
    }
    println!("| all | {} | {} | {:.1} % | at most {largest:.2} dB |", sums[0], sums[1], saved(sums[0], sums[1]));
    Ok(())
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), Box<dyn Error>> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else if path.extension().is_some_and(|kind| kind == "png" || kind == "jpg") {
            files.push(path);
        }
    }
    Ok(())
}

fn saved(before: usize, after: usize) -> f64 {
    100.0 * (1.0 - after as f64 / before as f64)
}

/// Returns the bytes of the file with the level, and the sum of squared errors of its decoded red, green and blue.
fn measured(blocks: Vec<u8>, texels: &Texels<'_>, effort: Effort) -> Result<(usize, f64), Box<dyn Error>> {
    let &Texels { width, height, .. } = texels;
    let format = PayloadFormat::UastcRgb;
    let levels = vec![StoredLevel::new(blocks, format, effort)?];
    let file = Ktx2Writer { format, width, height, levels, keys: &[] }.into_bytes()?;
    let decoded = Ktx2::parse(&file)?.decode_level(0)?;
    let source = texels.to_rgba8(false);
    let mut error = 0.0;
    for (k, texel) in source.chunks_exact(4).enumerate() {
        for (c, &level) in texel[..3].iter().enumerate() {
            let found = decoded.sample(k as u32 % width, k as u32 / width, c as u32).unwrap_or(0.0);
            error += f64::from(found * 255.0 - f32::from(level)).powi(2);
        }
    }
    Ok((file.len(), error))
}
