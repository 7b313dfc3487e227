//! Prints lobe errors by level: exact plain mips, both qualities, and the best lobe.
//!
//! `cargo run --release -p studies --bin levels [TEXELS] [TARGET] [NAME]` uses TEXELS texels per level and map, 16 by
//! default. TARGET is `float`, the default, or `basis` for bakes in UASTC. NAME selects the maps whose name contains
//! it. The program reads `../shared/data/maps` if it is present, and generates further maps, among them tiles of two
//! populations.

use std::error::Error;
use std::path::Path;

use roughcast::bake::{BaseRoughness, bake_map};
use roughcast::bump::{NormalLayout, NormalMap};
use roughcast::codec::Target;
use roughcast::codec::uastc::Effort;
use roughcast::decode::decode;
use roughcast::image::{DecodeOptions, Image, Samples};
use roughcast::lobe::{Alpha, Family, Roughness, SquaredAlpha};
use roughcast::material::BumpMap;
use roughcast::metric::{Peer, Surface, mean_errors, oracle, sample_texels};
use roughcast::settings::{Model, Settings};

#[path = "baked_levels.rs"]
mod baked_levels;

use baked_levels::{decoded, files_of};

const LEVELS: std::ops::RangeInclusive<u32> = 1..=9;

/// A normal map with the roughness of its material.
struct Material {
    name: String,
    normals: Image,
    /// Roughness in all channels; without an image the roughness is `factor`.
    roughness: Option<Image>,
    factor: f32,
}

fn main() -> Result<(), Box<dyn Error>> {
    let texels = std::env::args().nth(1).map_or(Ok(16), |n| n.parse::<usize>())?;
    let target = match std::env::args().nth(2).as_deref() {
        None | Some("float") => Target::Float,
        Some("basis") => Target::Basis,
        Some(other) => return Err(format!("expected the target float or basis, found {other}").into()),
    };
    let mut materials = generated();
    let shared = Path::new("../shared/data/maps");
    for name in
        ["aluminium_normal.png", "wool_normal.png", "sand_normal.jpg", "texture_bricks_normal.jpg", "water_normals.png"]
    {
        if let Ok(bytes) = std::fs::read(shared.join(name)) {
            let normals = decode(&bytes, &DecodeOptions::default())?;
            materials.push(Material { name: name.to_owned(), normals, roughness: None, factor: 0.316 });
        }
    }
    if let Some(name) = std::env::args().nth(3) {
        materials.retain(|material| material.name.contains(&name));
    }
    println!("| map | level | plain mips | fast | best | oracle | fast / oracle | best / oracle |");
    println!("|---|---|---|---|---|---|---|---|");
    let mut all = [0.0; 4];
    for material in &materials {
        let levels = errors(material, texels, target)?;
        for (level, [plain, fast, best, oracle]) in &levels {
            println!(
                "| {} | {level} | {plain:.3} | {fast:.3} | {best:.3} | {oracle:.3} | {:.2} | {:.2} |",
                material.name,
                fast / oracle,
                best / oracle
            );
        }
        let in_range: Vec<_> = levels.iter().filter(|(level, _)| (2..=7).contains(level)).collect();
        let mean = [0, 1, 2, 3].map(|i| in_range.iter().map(|(_, e)| e[i]).sum::<f64>() / in_range.len() as f64);
        let [plain, fast, best, oracle] = mean;
        println!(
            "| {} | 2 to 7 | {plain:.3} | {fast:.3} | {best:.3} | {oracle:.3} | {:.3} | {:.3} |",
            material.name,
            fast / oracle,
            best / oracle
        );
        all.iter_mut().zip(mean).for_each(|(sum, mean)| *sum += mean / materials.len() as f64);
    }
    let [plain, fast, best, oracle] = all;
    println!(
        "| all | 2 to 7 | {plain:.3} | {fast:.3} | {best:.3} | {oracle:.3} | {:.3} | {:.3} |",
        fast / oracle,
        best / oracle
    );
    Ok(())
}

/// The errors of plain mips, `fast`, `best` and the best lobe.
type LevelErrors = [f64; 4];

/// Returns the errors by level.
fn errors(material: &Material, texels: usize, target: Target) -> Result<Vec<(u32, LevelErrors)>, Box<dyn Error>> {
    let map = || NormalMap::new(material.normals.clone(), NormalLayout::Auto, false);
    let surface = surface(material, &map()?).ok_or("the sizes of normals and roughness differ")?;
    let surface = surface.magnified();
    let bump_map = BumpMap::Normals(map()?);
    let bake = |effort| -> Result<_, Box<dyn Error>> {
        let base = BaseRoughness { image: material.roughness.clone(), factor: material.factor };
        let settings = Settings::default()
            .with_model(Model::Anisotropic)
            .with_quality(effort)
            .with_target(target)
            .with_provenance(false);
        let baked = bake_map(&bump_map, Some(&base), &settings)?;
        Ok(files_of(&baked))
    };
    let (fast, best) = (bake(Effort::Fast)?, bake(Effort::Best)?);
    let size = material.normals.width.max(material.normals.height);
    let of_level = |level| {
        let (fast, best) = (decoded(&fast, level)?, decoded(&best, level)?);
        let size = (fast.normal.width, fast.normal.height);
        let errors =
            mean_errors(&surface, Family::Ggx, size, &sample_texels(size, texels), |(x, y), footprint, reference| {
                let plain = Peer::PlainMips.lobe(Family::Ggx, &footprint.moments());
                let ours = [&fast, &best].map(|decoded| decoded.lobe(Family::Ggx, x, y).unwrap_or(plain));
                let [fast, best] = ours;
                let errors = [plain, fast, best].map(|lobe| reference.error(&lobe));
                [errors[0], errors[1], errors[2], oracle(reference, &[plain, fast, best]).1]
            });
        Ok((level, errors))
    };
    LEVELS.filter(|level| size >> level > 0).map(of_level).collect()
}

fn surface(material: &Material, map: &NormalMap) -> Option<Surface> {
    let (width, height) = (map.width(), map.height());
    let mut row = vec![[0.0; 3]; width as usize];
    let (mut normals, mut base) = (Vec::new(), Vec::new());
    for y in 0..height {
        map.row(y, &mut row);
        for (x, normal) in (0..).zip(&row) {
            normals.push(normal.map(f64::from));
            let roughness = material.roughness.as_ref().map_or(Some(1.0), |image| image.sample(x, y, 1))?;
            base.push(SquaredAlpha::isotropic(Alpha::from(Roughness(roughness * material.factor))));
        }
    }
    Surface::new(width, height, &normals, &base)
}

const SIDE: u32 = 512;

/// Returns generated materials: mirror tiles beside rough grout, with small slopes and with steep grout; low relief;
/// and noise with 1 % steep outliers.
fn generated() -> Vec<Material> {
    let tile = |x: u32, y: u32| x % 37 < 5 || y % 29 < 5;
    let noise = |x: u32, y: u32, seed: u32| {
        let mixed = (x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77) ^ seed.wrapping_mul(0xc2b2_ae3d))
            .wrapping_mul(0x27d4_eb2f);
        let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x2c1b_3c6d);
        f64::from(mixed ^ (mixed >> 13)) / f64::from(u32::MAX) - 0.5
    };
    let rough = |mirror: f64, grout: f64| {
        image(move |x, y| {
            let r = if tile(x, y) { grout } else { mirror };
            [r, r, r]
        })
    };
    let material = |name: &str, slope: &dyn Fn(u32, u32) -> [f64; 2], roughness: Option<Image>, factor| Material {
        name: name.to_owned(),
        normals: image(|x, y| {
            let [u, v] = slope(x, y);
            let length = (u * u + v * v + 1.0).sqrt();
            [-u / length, -v / length, 1.0 / length].map(|c| 0.5 * c + 0.5)
        }),
        roughness,
        factor,
    };
    let tiles = |steep: f64| {
        move |x: u32, y: u32| {
            let amplitude = if tile(x, y) { steep } else { 0.02 };
            [amplitude * noise(x, y, 1), amplitude * noise(x, y, 2)]
        }
    };
    let outliers = |x: u32, y: u32| {
        let amplitude = if noise(x, y, 3) > 0.49 { 40.0 } else { 0.2 };
        [amplitude * noise(x, y, 1), amplitude * noise(x, y, 2)]
    };
    let polished = |x: u32, y: u32| {
        let scratch = if (x + y / 5).is_multiple_of(43) { 0.05 } else { 0.0 };
        [scratch + 0.01 * noise(x / 4, y / 4, 1), 0.01 * noise(x / 4, y / 4, 2)]
    };
    vec![
        material("tiles, alpha 0.01 and 0.5", &tiles(0.8), Some(rough(0.1, 0.707)), 1.0),
        material("tiles, alpha 0.09 and 0.36", &tiles(0.3), Some(rough(0.3, 0.6)), 1.0),
        material("low relief, alpha 0.04", &polished, None, 0.2),
        material("1 % outliers, alpha 0.1", &outliers, None, 0.316),
    ]
}

fn image(texel: impl Fn(u32, u32) -> [f64; 3]) -> Image {
    let texels = (0..SIDE * SIDE).flat_map(|i| texel(i % SIDE, i / SIDE));
    let samples = texels.map(|c| (c * 65535.0).round().clamp(0.0, 65535.0) as u16).collect();
    Image { width: SIDE, height: SIDE, channels: 3, samples: Samples::U16(samples) }
}
