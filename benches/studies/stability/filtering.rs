//! D as samplers filter it between texels and between levels.

use std::error::Error;
use std::path::Path;

use roughcast::bump::{Moments, NormalLayout, NormalMap};
use roughcast::decode::decode;
use roughcast::image::DecodeOptions;
use roughcast::lobe::Factor;
use roughcast::material::BumpMap;
use roughcast::math::symmetric::Symmetric2;
use roughcast::mip::Pyramid;

use super::{head, row};

const MAPS: [&str; 5] =
    ["aluminium_normal.png", "wool_normal.png", "sand_normal.jpg", "texture_bricks_normal.jpg", "water_normals.png"];
const FIXTURES: [&str; 2] = ["two_channel_normal.png", "vgroove_normal.png"];

/// Variance (trace of K), and the variance of the filtered D, summed over sample points.
#[derive(Clone, Copy, Default)]
struct Sums {
    kept: f64,
    exact: f64,
}

impl Sums {
    /// Adds the point halfway between two texels.
    fn add(&mut self, a: Symmetric2, b: Symmetric2) {
        let (d, e) = (Factor::of(a), Factor::of(b));
        let mean = Factor { d1: 0.5 * (d.d1 + e.d1), d2: 0.5 * (d.d2 + e.d2), d3: 0.5 * (d.d3 + e.d3) };
        self.kept += f64::from(mean.covariance().trace());
        self.exact += 0.5 * f64::from((a + b).trace());
    }

    fn lost(self) -> String {
        format!("{:.1} %", 100.0 * (1.0 - self.kept / self.exact))
    }
}

pub fn print() -> Result<(), Box<dyn Error>> {
    head("Filtering D in place of K: variance lost", &["K of the two texels", "halfway between them"]);
    let cases = [
        ("alike", [Symmetric2::outer([0.3, 0.1]); 2]),
        ("brushed, 4 times as rough", [Symmetric2::outer([0.2, 0.0]), Symmetric2::outer([0.4, 0.0])]),
        ("flat and bumpy", [Symmetric2::ZERO, Symmetric2::diagonal(0.1, 0.1)]),
        ("brushed along u and along v", [Symmetric2::outer([0.3, 0.0]), Symmetric2::outer([0.0, 0.3])]),
        ("brushed at +45 and -45 degrees", [Symmetric2::outer([0.3, 0.3]), Symmetric2::outer([0.3, -0.3])]),
    ];
    for (name, [a, b]) in cases {
        let mut sums = Sums::default();
        sums.add(a, b);
        row(&[name.to_owned(), sums.lost()]);
    }

    let shared = Path::new("../shared/data/maps");
    let (folder, names) =
        if shared.is_dir() { (shared, &MAPS[..]) } else { (Path::new("fixtures/maps"), &FIXTURES[..]) };
    head(
        "On maps",
        &["map", "between texels, level 1", "level 3", "level 5", "between levels 1 and 2", "3 and 4", "5 and 6"],
    );
    for name in names {
        let image = decode(&std::fs::read(folder.join(name))?, &DecodeOptions::default())?;
        let pyramid = Pyramid::new(BumpMap::Normals(NormalMap::new(image, NormalLayout::Auto, false)?));
        let sums = [1, 3, 5].map(|level| between_texels(&pyramid, level).lost());
        let levels = [1, 3, 5].map(|level| between_levels(&pyramid, level).lost());
        row(&[vec![(*name).to_owned()], sums.to_vec(), levels.to_vec()].concat());
    }
    Ok(())
}

fn texel_rows(pyramid: &Pyramid<BumpMap>, level: usize) -> Vec<Vec<Moments>> {
    let (width, height) = pyramid.sizes()[level];
    let row = |y| {
        let mut row = vec![Moments::default(); width as usize];
        pyramid.row(level, y, &mut row);
        row
    };
    (0..height).map(row).collect()
}

fn between_texels(pyramid: &Pyramid<BumpMap>, level: usize) -> Sums {
    let rows = texel_rows(pyramid, level);
    let mut sums = Sums::default();
    for (y, row) in rows.iter().enumerate() {
        let right = row.iter().zip(row.iter().skip(1));
        let down = row.iter().zip(rows.get(y + 1).into_iter().flatten());
        right.chain(down).for_each(|(a, b)| sums.add(a.covariance, b.covariance));
    }
    sums
}

/// Returns each texel of a level with the texel of the next coarser level that covers it.
fn between_levels(pyramid: &Pyramid<BumpMap>, level: usize) -> Sums {
    let (fine, coarse) = (texel_rows(pyramid, level), texel_rows(pyramid, level + 1));
    let mut sums = Sums::default();
    for (y, row) in fine.iter().enumerate() {
        let above = &coarse[(y / 2).min(coarse.len() - 1)];
        for (x, texel) in row.iter().enumerate() {
            sums.add(texel.covariance, above[(x / 2).min(above.len() - 1)].covariance);
        }
    }
    sums
}
