//! Prints the accuracy table of docs/accuracy.md as markdown.
//!
//! `cargo run --release --example accuracy [TEXELS]`: TEXELS per level and map, 16 unless given. Reads
//! `../shared/data/maps`, else `fixtures/maps`.

use std::error::Error;
use std::path::Path;

use roughcast::bake::report::Content;
use roughcast::bake::{BareBake, Model, OwnRoughness, Relief, Settings, bake_map};
use roughcast::judge::{Decoded, Family, Peer, Surface, mean_errors, oracle, sample_texels};
use roughcast::lobe::{Alpha, Roughness, SquaredAlpha};
use roughcast::map::{DecodeOptions, Image, NormalLayout, NormalMap, decode};
use roughcast::texture::ktx2::Ktx2;

const MAPS: [&str; 5] =
    ["aluminium_normal.png", "wool_normal.png", "sand_normal.jpg", "texture_bricks_normal.jpg", "water_normals.png"];
const FIXTURES: [&str; 2] = ["two_channel_normal.png", "vgroove_normal.png"];
const ALPHAS: [f32; 4] = [0.05, 0.1, 0.2, 0.4];
const LEVELS: std::ops::RangeInclusive<u32> = 2..=7;
/// Peers, then ours isotropic and anisotropic, then the oracle.
const COLUMNS: usize = Peer::ALL.len() + 3;

/// Levels and their mean errors.
type Levels = Vec<(u32, [f64; COLUMNS])>;

fn main() -> Result<(), Box<dyn Error>> {
    let texels = std::env::args().nth(1).map_or(Ok(16), |n| n.parse::<usize>())?;
    let shared = Path::new("../shared/data/maps");
    let folder = if shared.is_dir() { shared } else { Path::new("fixtures/maps") };
    let names: &[&str] = if folder == shared { &MAPS } else { &FIXTURES };
    let paths: Vec<_> = names.iter().map(|name| folder.join(name)).collect();
    print!("| map | alpha |");
    Peer::ALL.iter().for_each(|peer| print!(" {} |", peer.name()));
    println!(" ours, isotropic | ours, anisotropic | oracle |");
    println!("|---|---|{}", "---|".repeat(COLUMNS));
    let (mut worst_against_peers, mut count, mut total) = ((f64::NEG_INFINITY, String::new()), 0.0, [0.0; COLUMNS]);
    for path in &paths {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let image = decode(&std::fs::read(path)?, &DecodeOptions::default())?;
        for alpha in ALPHAS {
            let levels = errors_by_level(&image, alpha, texels)?;
            let mut mean = [0.0; COLUMNS];
            for (level, errors) in &levels {
                let best = errors[..Peer::ALL.len()].iter().copied().fold(f64::INFINITY, f64::min);
                let excess = errors[COLUMNS - 2] - best;
                if excess > worst_against_peers.0 {
                    worst_against_peers = (excess, format!("{name}, alpha {alpha}, level {level}"));
                }
                mean.iter_mut().zip(errors).for_each(|(m, e)| *m += e / levels.len() as f64);
            }
            print_row(&name, &alpha.to_string(), &mean);
            total.iter_mut().zip(mean).for_each(|(t, m)| *t += m);
            count += 1.0;
        }
    }
    print_row("all", "all", &total.map(|t| t / count));
    println!();
    println!(
        "Anisotropic against the best peer of each map, alpha and level: at worst {:+.3} ({}).",
        worst_against_peers.0, worst_against_peers.1
    );
    Ok(())
}

fn print_row(map: &str, alpha: &str, errors: &[f64; COLUMNS]) {
    print!("| {map} | {alpha} |");
    errors.iter().for_each(|error| print!(" {error:.3} |"));
    println!();
}

/// Mean errors of each level that the map has.
fn errors_by_level(image: &Image, alpha: f32, texels: usize) -> Result<Levels, Box<dyn Error>> {
    let map = || NormalMap::new(image.clone(), NormalLayout::Auto, false);
    let surface = Surface::of_map(&map()?, SquaredAlpha::isotropic(Alpha(alpha)));
    let relief = Relief::Normals(map()?);
    let bake = |model| {
        let own = OwnRoughness { image: None, factor: Roughness::from(Alpha(alpha)).0 };
        bake_map(&relief, Some(&own), &Settings { model, provenance: false, ..Settings::default() })
    };
    let baked = [bake(Model::Isotropic)?, bake(Model::Anisotropic)?];
    let files = baked.each_ref().map(files);
    LEVELS
        .filter(|level| image.width.max(image.height) >> level > 0)
        .map(|level| {
            let [isotropic, anisotropic] = [decoded(&files[0], level)?, decoded(&files[1], level)?];
            let size = (isotropic.normal.width, isotropic.normal.height);
            let texels = sample_texels(size, texels);
            let means = mean_errors(&surface, Family::Ggx, size, &texels, |(x, y), footprint, reference| {
                let moments = footprint.moments();
                let peers = Peer::ALL.map(|peer| peer.lobe(Family::Ggx, &moments));
                let ours = [&isotropic, &anisotropic].map(|d| d.lobe(Family::Ggx, x, y));
                let mut errors = [f64::NAN; COLUMNS];
                for (error, lobe) in
                    errors.iter_mut().zip(peers.iter().map(Some).chain(ours.iter().map(Option::as_ref)))
                {
                    *error = lobe.map_or(1.0, |lobe| reference.error(lobe));
                }
                let starts: Vec<_> = peers.into_iter().chain(ours.into_iter().flatten()).collect();
                errors[COLUMNS - 1] = oracle(reference, &starts).1;
                errors
            });
            Ok((level, means))
        })
        .collect()
}

/// The KTX2 files of a bake: a texture's content and its bytes.
fn files(baked: &BareBake) -> Vec<(Content, Vec<u8>)> {
    let effort = Settings::default().effort;
    baked.textures.iter().map(|t| (t.content, t.chain.to_ktx2(&[], effort))).collect()
}

fn decoded(files: &[(Content, Vec<u8>)], level: u32) -> Result<Decoded, Box<dyn Error>> {
    let of = |content| -> Result<Option<Image>, Box<dyn Error>> {
        let file = files.iter().find(|f| f.0 == content);
        file.map(|(_, bytes)| Ok(Ktx2::parse(bytes)?.decode_level(level)?)).transpose()
    };
    Ok(Decoded {
        normal: of(Content::Normal)?.ok_or("the bake has no normals")?,
        roughness: of(Content::Roughness)?,
        roughness_factor: 1.0,
        anisotropy: of(Content::Anisotropy)?,
    })
}
