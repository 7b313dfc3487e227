//! Prints the accuracy table of docs/accuracy.md as markdown.
//!
//! `cargo run --release -p studies --bin accuracy [TEXELS [MAP...]]` uses TEXELS texels per level and map, 16 by
//! default. Without a MAP it reads five maps of `../shared/data/maps`, or else two of `fixtures/maps`.

use std::array::from_fn;
use std::error::Error;
use std::path::{Path, PathBuf};

use roughcast::bake::{BaseRoughness, bake_map};
use roughcast::bump::{NormalLayout, NormalMap};
use roughcast::codec::Target;
use roughcast::codec::uastc::Effort;
use roughcast::decode::decode;
use roughcast::image::{DecodeOptions, Image};
use roughcast::lobe::{Alpha, Family, Roughness, SquaredAlpha};
use roughcast::material::BumpMap;
use roughcast::metric::{Decoded, Lobe, Peer, Surface, mean_errors, oracle, sample_texels};
use roughcast::settings::{Model, Settings};

#[path = "baked_levels.rs"]
mod baked_levels;

use baked_levels::{decoded, files_of};

const MAPS: [&str; 5] =
    ["aluminium_normal.png", "wool_normal.png", "sand_normal.jpg", "texture_bricks_normal.jpg", "water_normals.png"];
const FIXTURES: [&str; 2] = ["two_channel_normal.png", "vgroove_normal.png"];
const ALPHAS: [f32; 4] = [0.05, 0.1, 0.2, 0.4];
const LEVELS: std::ops::RangeInclusive<u32> = 2..=7;
/// Our bakes: isotropic and anisotropic with `fast`, anisotropic with `best`, and both qualities without block
/// encoding.
const OURS: [(&str, Model, Effort, Target); 5] = [
    ("ours, isotropic", Model::Isotropic, Effort::Fast, Target::Basis),
    ("ours, fast", Model::Anisotropic, Effort::Fast, Target::Basis),
    ("ours, best", Model::Anisotropic, Effort::Best, Target::Basis),
    ("fast, float", Model::Anisotropic, Effort::Fast, Target::Float),
    ("best, float", Model::Anisotropic, Effort::Best, Target::Float),
];
const PEERS: usize = Peer::ALL.len();
/// Columns: peers, then our bakes, then the oracle.
const COLUMNS: usize = PEERS + OURS.len() + 1;
const FAST: usize = PEERS + 1;
const BEST: usize = PEERS + 2;

/// Mean errors of a level.
struct Means {
    level: u32,
    errors: [f64; COLUMNS],
    /// Errors of the peers where peers too are read from encoded normals. Their roughness stays exact.
    encoded_peers: [f64; PEERS],
}

fn main() -> Result<(), Box<dyn Error>> {
    let texels = std::env::args().nth(1).map_or(Ok(16), |n| n.parse::<usize>())?;
    let shared = Path::new("../shared/data/maps");
    let folder = if shared.is_dir() { shared } else { Path::new("fixtures/maps") };
    let names: &[&str] = if folder == shared { &MAPS } else { &FIXTURES };
    let mut paths: Vec<PathBuf> = std::env::args().skip(2).map(PathBuf::from).collect();
    if paths.is_empty() {
        paths.extend(names.iter().map(|name| folder.join(name)));
    }
    print!("| map | alpha |");
    Peer::ALL.iter().for_each(|peer| print!(" {} |", peer.name()));
    OURS.iter().for_each(|ours| print!(" {} |", ours.0));
    println!(" oracle |");
    println!("|---|---|{}", "---|".repeat(COLUMNS));
    let mut worst =
        [(FAST, false), (BEST, false), (FAST, true), (BEST, true)].map(|case| (case, f64::NEG_INFINITY, String::new()));
    let mut of_maps = Vec::new();
    for path in &paths {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let image = decode(&std::fs::read(path)?, &DecodeOptions::default())?;
        let mut of_map = [0.0; COLUMNS];
        for alpha in ALPHAS {
            let levels = errors_by_level(&image, alpha, texels)?;
            let mut mean = [0.0; COLUMNS];
            for Means { level, errors, encoded_peers } in &levels {
                for ((column, encoded), excess, place) in &mut worst {
                    let peers = if *encoded { encoded_peers } else { &errors[..PEERS] };
                    let best = peers.iter().copied().fold(f64::INFINITY, f64::min);
                    if errors[*column] - best > *excess {
                        (*excess, *place) = (errors[*column] - best, format!("{name}, alpha {alpha}, level {level}"));
                    }
                }
                mean.iter_mut().zip(errors).for_each(|(m, e)| *m += e / levels.len() as f64);
            }
            print_row(&name, &alpha.to_string(), &mean);
            of_map.iter_mut().zip(mean).for_each(|(sum, m)| *sum += m / ALPHAS.len() as f64);
        }
        of_maps.push((name, of_map));
    }
    let all = from_fn(|i| of_maps.iter().map(|(_, errors)| errors[i]).sum::<f64>() / of_maps.len() as f64);
    print_row("all", "all", &all);
    of_maps.push(("all".to_owned(), all));
    print_ratios(&of_maps);
    println!();
    for ((column, encoded), excess, place) in worst {
        let (name, peers) = (OURS[column - PEERS].0, if encoded { "encoded" } else { "exact" });
        println!(
            "{name}, against the best of the {peers} peers at each map, alpha and level: at worst {excess:+.3} ({place})."
        );
    }
    Ok(())
}

fn print_row(map: &str, alpha: &str, errors: &[f64; COLUMNS]) {
    print!("| {map} | {alpha} |");
    // Blocks need sizes that are multiples of 4, and floats keep the size of the map. Such levels have no texels to
    // compare.
    errors.iter().for_each(|error| if error.is_nan() { print!(" - |") } else { print!(" {error:.3} |") });
    println!();
}

/// Prints the ratios of docs/accuracy.md: our errors over those of the oracle, and over those of the best isotropic
/// peer.
fn print_ratios(of_maps: &[(String, [f64; COLUMNS])]) {
    print!("\n| map | best isotropic peer / oracle |");
    OURS.iter().for_each(|ours| print!(" {} / oracle |", ours.0));
    println!(" ours, fast / that peer | ours, best / that peer | oracle / that peer |");
    println!("|---|---|{}---|---|---|", "---|".repeat(OURS.len()));
    for (name, errors) in of_maps {
        let peers = errors.iter().zip(Peer::ALL).filter(|(_, peer)| peer.is_isotropic());
        let (peer, oracle) = (peers.map(|(e, _)| *e).fold(f64::INFINITY, f64::min), errors[COLUMNS - 1]);
        print!("| {name} | {:.2} |", peer / oracle);
        let ratios = errors[PEERS..COLUMNS - 1].iter().map(|e| e / oracle);
        ratios.for_each(|r| if r.is_nan() { print!(" - |") } else { print!(" {r:.2} |") });
        println!(" {:.3} | {:.3} | {:.3} |", errors[FAST] / peer, errors[BEST] / peer, oracle / peer);
    }
}

/// Returns the mean errors of each level of the map.
fn errors_by_level(image: &Image, alpha: f32, texels: usize) -> Result<Vec<Means>, Box<dyn Error>> {
    let map = || NormalMap::new(image.clone(), NormalLayout::Auto, false);
    let surface = Surface::of_map(&map()?, SquaredAlpha::isotropic(Alpha(alpha))).magnified();
    let bump_map = BumpMap::Normals(map()?);
    let bake = |model, effort, target| -> Result<_, Box<dyn Error>> {
        let base = BaseRoughness { image: None, factor: Roughness::from(Alpha(alpha)).0 };
        let settings =
            Settings::default().with_model(model).with_quality(effort).with_target(target).with_provenance(false);
        Ok(files_of(&bake_map(&bump_map, Some(&base), &settings)?))
    };
    let files = OURS.map(|(_, model, effort, target)| bake(model, effort, target));
    let files = files.into_iter().collect::<Result<Vec<_>, _>>()?;
    let plain = bake(Model::None, Effort::Fast, Target::Basis)?;
    LEVELS
        .filter(|level| image.width.max(image.height) >> level > 0)
        .map(|level| {
            let baked = files.iter().map(|files| decoded(files, level)).collect::<Result<Vec<_>, _>>()?;
            let plain = decoded(&plain, level)?;
            let size_of = |decoded: &Decoded| (decoded.normal.width, decoded.normal.height);
            let size = size_of(&plain);
            let texels = sample_texels(size, texels);
            let means = mean_errors(&surface, Family::Ggx, size, &texels, |(x, y), footprint, reference| {
                let moments = footprint.moments();
                let peers = Peer::ALL.map(|peer| peer.lobe(Family::Ggx, &moments));
                let ours = baked.iter().map(|d| d.lobe(Family::Ggx, x, y).filter(|_| size_of(d) == size));
                let lobes: Vec<_> = peers.into_iter().map(Some).chain(ours).collect();
                let mut errors = [f64::NAN; COLUMNS + PEERS];
                for (error, lobe) in errors.iter_mut().zip(&lobes) {
                    *error = lobe.as_ref().map_or(f64::NAN, |lobe| reference.error(lobe));
                }
                if let Some(plain) = plain.lobe(Family::Ggx, x, y) {
                    for (error, peer) in errors[COLUMNS..].iter_mut().zip(&peers) {
                        *error = reference.error(&Lobe::new(Family::Ggx, plain.normal(), peer.squared_alpha()));
                    }
                }
                let starts: Vec<_> = lobes.into_iter().flatten().collect();
                errors[COLUMNS - 1] = oracle(reference, &starts).1;
                errors
            });
            Ok(Means { level, errors: from_fn(|i| means[i]), encoded_peers: from_fn(|i| means[COLUMNS + i]) })
        })
        .collect()
}
