//! Compares the quick survey of `bake` with full references.
//!
//! `cargo run --release -p studies --bin survey` takes the mean lobe errors of plain mips, corrected vMF and D over 64
//! texels of each map and level. It compares references from the survey with full references at the same texels, and
//! with full references at four times as many other texels. It reads `../shared/data/maps`, else `fixtures/maps`.

use std::error::Error;
use std::path::{Path, PathBuf};

use roughcast::bump::{Moments, NormalLayout, NormalMap, NormalOffsets};
use roughcast::decode::decode;
use roughcast::image::DecodeOptions;
use roughcast::lobe::{Alpha, Family, OrientedLobe, SquaredAlpha};
use roughcast::metric::{Peer, Precision, Surface, mean_errors, sample_sites, sample_texels};
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

fn main() -> Result<(), Box<dyn Error>> {
    let folders = ["../shared/data/maps", "fixtures/maps"].map(Path::new);
    let folder = folders.into_iter().find(|f| f.is_dir()).ok_or("expected ../shared/data/maps or fixtures/maps")?;
    let entries = std::fs::read_dir(folder)?.collect::<Result<Vec<_>, _>>()?;
    let mut paths: Vec<PathBuf> = entries.into_iter().map(|e| e.path()).collect();
    paths.retain(|path| path.to_string_lossy().contains("_normal"));
    paths.sort();
    let (mut same, mut more) = (Differences::default(), Differences::default());
    for path in &paths {
        let map = NormalMap::new(decode(&std::fs::read(path)?, &DecodeOptions::default())?, NormalLayout::Auto, false)?;
        for alpha in ALPHAS {
            compare(&map, alpha, &mut same, &mut more);
        }
        println!("{}: same texels: {}", path.display(), same.text());
    }
    println!("all: same texels: {}", same.text());
    println!("all: against four times as many texels: {}", more.text());
    Ok(())
}

fn compare(map: &NormalMap, alpha: f32, same: &mut Differences, more: &mut Differences) {
    let sizes = level_sizes(map.width(), map.height());
    let surface = Surface::of_map(map, SquaredAlpha::isotropic(Alpha(alpha)));
    let rows = |first: u32, out: &mut [OrientedLobe]| {
        let mut texels = vec![Moments::default(); out.len()];
        NormalOffsets::new(map).rows(first, &mut texels);
        for (lobe, m) in out.iter_mut().zip(texels) {
            *lobe = OrientedLobe::new(m.mean, SquaredAlpha::isotropic(Alpha(alpha)));
        }
    };
    let precision = Precision::QUICK;
    let sites = sample_sites(&sizes, 1..sizes.len(), Family::Ggx, precision, &rows);
    for (level, &size) in sizes.iter().enumerate().skip(1) {
        let of: Vec<_> = sites.iter().filter(|s| s.level == level).collect();
        let mut quick = [0.0; PEERS.len()];
        for site in &of {
            // Lobes are from whole footprints. Only the reference that they are compared with is surveyed.
            let moments = surface.footprint(size, site.texel).moments();
            for (sum, peer) in quick.iter_mut().zip(PEERS) {
                *sum += site.reference.error(&peer.lobe(Family::Ggx, &moments)) / of.len() as f64;
            }
        }
        let full = |texels| {
            mean_errors(&surface, Family::Ggx, size, &sample_texels(size, texels), |_, footprint, reference| {
                let moments = footprint.moments();
                PEERS.map(|peer| reference.error(&peer.lobe(Family::Ggx, &moments)))
            })
        };
        quick.iter().zip(full(precision.texels)).for_each(|(quick, full)| same.add(quick - full));
        // Whole footprints of coarse levels take minutes, and those levels have no more texels.
        if level <= 5 {
            quick.iter().zip(full(4 * precision.texels)).for_each(|(quick, full)| more.add(quick - full));
        }
    }
}
