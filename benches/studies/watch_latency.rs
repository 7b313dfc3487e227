//! Measures how long `roughcast watch` takes from a save to the baked output, for a material of 1024x1024 texels.
//!
//! `cargo build --release && cargo run --release -p studies --bin watch_latency` saves a normal map repeatedly, with
//! new texels each time. It prints the time from before the save until the event `baked` arrives. `--bin PATH` names
//! another command than `target/release/roughcast`. Arguments after `--` go to that command (`-- --model isotropic`).

use std::error::Error;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Instant;

use image::{Rgb, RgbImage};

/// Side of the maps.
const SIDE: u32 = 1024;
const SAVES: u32 = 10;

struct Watching(Child);

impl Drop for Watching {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1).peekable();
    let mut command = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/release/roughcast");
    if arguments.next_if(|argument| argument == "--bin").is_some() {
        command = PathBuf::from(arguments.next().ok_or("expected a path after --bin, found none")?);
    }
    let options: Vec<String> = arguments.filter(|argument| argument != "--").collect();
    let folder = tempfile::tempdir()?;
    let assets = folder.path().join("assets");
    fs::create_dir(&assets)?;
    let (normal, surface) = (assets.join("normal.png"), assets.join("surface.png"));
    bumps(0).save(&normal)?;
    RgbImage::from_fn(SIDE, SIDE, |x, y| Rgb([255, 90 + ((x * 7) ^ (y * 13)) as u8 % 64, 0])).save(&surface)?;
    let document = r#"{"asset":{"version":"2.0"},"images":[{"uri":"normal.png"},{"uri":"surface.png"}],
        "textures":[{"source":0},{"source":1}],"materials":[{"normalTexture":{"index":0},
        "pbrMetallicRoughness":{"metallicRoughnessTexture":{"index":1}}}]}"#;
    fs::write(assets.join("material.gltf"), document)?;
    let mut child = Watching(
        Command::new(&command)
            .current_dir(folder.path())
            .args(["watch", "assets", "-o", "out", "--json"])
            .args(&options)
            .stdout(Stdio::piped())
            .spawn()?,
    );
    let mut lines = BufReader::new(child.0.stdout.take().ok_or("expected a pipe")?).lines();
    let mut wait_for = |event: &str| -> Result<(Instant, String), Box<dyn Error>> {
        loop {
            let line = lines.next().ok_or("expected events, found that watch ended")??;
            if line.contains(&format!("\"event\":\"{event}\"")) {
                return Ok((Instant::now(), line));
            }
        }
    };
    wait_for("idle")?;
    let (mut latencies, mut bakes) = (Vec::new(), Vec::new());
    for save in 1..=SAVES {
        let mut bytes = std::io::Cursor::new(Vec::new());
        bumps(save).write_to(&mut bytes, image::ImageFormat::Png)?;
        let start = Instant::now();
        fs::write(&normal, bytes.into_inner())?;
        let (end, line) = wait_for("baked")?;
        latencies.push((end - start).as_secs_f64());
        let event: serde_json::Value = serde_json::from_str(&line)?;
        bakes.extend(event["seconds"].as_f64());
        wait_for("idle")?;
    }
    let (latency, bake) = (median(latencies), median(bakes));
    println!("{SIDE}x{SIDE}, {SAVES} saves, options {options:?}");
    println!(
        "from save to baked: median {:.3} s, longest {:.3} s; of it the bake {:.3} s",
        latency.0, latency.1, bake.0
    );
    Ok(())
}

/// Makes a normal map with different grain for each `save`.
fn bumps(save: u32) -> RgbImage {
    RgbImage::from_fn(SIDE, SIDE, |x, y| {
        let hash = (x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca6b) ^ save).wrapping_mul(0xc2b2_ae35);
        let wave = ((x as f32 * 0.05).sin() * 40.0) as i32;
        let [u, v] =
            [(hash >> 24) & 31, (hash >> 16) & 31].map(|grain| (112 + grain as i32 + wave / 2).clamp(0, 255) as u8);
        Rgb([u, v, 240])
    })
}

fn median(mut seconds: Vec<f64>) -> (f64, f64) {
    seconds.sort_by(f64::total_cmp);
    (seconds.get(seconds.len() / 2).copied().unwrap_or(0.0), seconds.last().copied().unwrap_or(0.0))
}
