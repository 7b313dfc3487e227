//! Compares the quick survey of `bake` with an exhaustive count.
//!
//! `cargo run --release -p studies --bin survey` takes the mean lobe errors of plain mips, corrected vMF and D on each
//! map and level from 1 to 6: over the texels and samples of the survey, and over all texels of the level, with whole
//! footprints and at least 32 samples for each texel. It reads `../shared/data/maps`, else `fixtures/maps`.

use std::error::Error;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use roughcast::bump::{Moments, NormalLayout, NormalMap, NormalOffsets};
use roughcast::decode::decode;
use roughcast::image::DecodeOptions;
use roughcast::lobe::{Alpha, Family, OrientedLobe, SquaredAlpha};
use roughcast::metric::{Peer, Precision, Site, Surface, sample_sites};
use roughcast::mip::{TexelRows, level_sizes};

const PEERS: [Peer; 3] = [Peer::PlainMips, Peer::CorrectedVmf, Peer::D];
const ALPHAS: [f32; 2] = [0.05, 0.2];

/// Differences from the full references.
#[derive(Default)]
struct Differences {
    count: f64,
    sum: f64,
    squares: f64,
    largest: f64,
}

impl Differences {
    fn add(&mut self, difference: f64) {
        self.count += 1.0;
        self.sum += difference;
        self.squares += difference * difference;
        self.largest = self.largest.max(difference.abs());
    }

    fn text(&self) -> String {
        let (mean, root) = (self.sum / self.count, (self.squares / self.count).sqrt());
        format!("mean {mean:+.4}, root mean square {root:.4}, at most {:.4}", self.largest)
    }
}

/// The last level at which hundreds of texels are counted.
const LAST_FINE: usize = 4;

/// All texels of a level, and whole footprints.
const ALL: Precision =
    Precision { texels: usize::MAX, least: usize::MAX, rows: usize::MAX, level0: u32::MAX, half_vectors: 1 << 23 };

fn main() -> Result<(), Box<dyn Error>> {
    let folders = ["../shared/data/maps", "fixtures/maps"].map(Path::new);
    let folder = folders.into_iter().find(|f| f.is_dir()).ok_or("expected ../shared/data/maps or fixtures/maps")?;
    let entries = std::fs::read_dir(folder)?.collect::<Result<Vec<_>, _>>()?;
    let mut paths: Vec<PathBuf> = entries.into_iter().map(|e| e.path()).collect();
    paths.retain(|path| path.to_string_lossy().contains("_normal"));
    paths.sort();
    let (mut all, mut fine) = (Differences::default(), Differences::default());
    for path in &paths {
        let map = NormalMap::new(decode(&std::fs::read(path)?, &DecodeOptions::default())?, NormalLayout::Auto, false)?;
        let mut of_map = Differences::default();
        for alpha in ALPHAS {
            for level in 1..=6.min(level_sizes(map.width(), map.height()).len() - 1) {
                let [quick, exhaustive] =
                    [Precision::QUICK, ALL].map(|precision| errors(&map, alpha, level, precision));
                for (quick, exhaustive) in quick.iter().zip(exhaustive) {
                    of_map.add(quick - exhaustive);
                    all.add(quick - exhaustive);
                    if level <= LAST_FINE {
                        fine.add(quick - exhaustive);
                    }
                }
            }
        }
        println!("{}: {}", path.display(), of_map.text());
    }
    println!("all, levels 1 to {LAST_FINE}: {}", fine.text());
    println!("all: {}", all.text());
    Ok(())
}

/// Returns the mean error of each peer at a level.
fn errors(map: &NormalMap, alpha: f32, level: usize, precision: Precision) -> [f64; PEERS.len()] {
    let sizes = level_sizes(map.width(), map.height());
    let surface = Surface::of_map(map, SquaredAlpha::isotropic(Alpha(alpha)));
    let rows = |first: u32, out: &mut [OrientedLobe]| {
        let mut texels = vec![Moments::default(); out.len()];
        NormalOffsets::new(map).rows(first, &mut texels);
        for (lobe, m) in out.iter_mut().zip(texels) {
            *lobe = OrientedLobe::new(m.mean, SquaredAlpha::isotropic(Alpha(alpha)));
        }
    };
    let sites = sample_sites(&sizes, level..level + 1, Family::Ggx, precision, &rows);
    let of_site = |site: &Site| {
        // Lobes are from whole footprints. Only the reference that they are compared with is surveyed.
        let moments = surface.footprint(sizes[level], site.texel).moments();
        PEERS.map(|peer| site.reference.error(&peer.lobe(Family::Ggx, &moments)))
    };
    let each: Vec<_> = sites.par_iter().map(of_site).collect();
    std::array::from_fn(|i| each.iter().map(|errors| errors[i]).sum::<f64>() / each.len() as f64)
}
