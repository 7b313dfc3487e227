//! Fits the correction tables of `crates/core/src/lobe/table.rs` and prints that file.
//!
//! `cargo run --release -p studies --bin correction_table > crates/core/src/lobe/table.rs` takes some minutes. The
//! tables have the least mean lobe error over synthetic footprints (`synthetic.rs`). No real map is used.

mod synthetic;

use rayon::prelude::*;

use roughcast::bump::{Moments, Offset, ShapedMoments};
use roughcast::lobe::{Family, KURTOSES, Lattice, LatticePoint, RATIOS, Shape};
use roughcast::metric::{Footprint, Lobe, Part, Reference};
use roughcast::mip::Merge;

const FAMILIES: [(&str, &str, Family); 2] =
    [("GGX", "Trowbridge-Reitz.", Family::Ggx), ("BECKMANN", "Normally distributed slopes.", Family::Beckmann)];
const FOOTPRINTS: usize = 6000;
const SAMPLES: usize = 1024;
/// Steepest slope: so small that a tilted lobe is a shifted lobe, as the tables assume.
const STEEPEST: f64 = 0.2;
/// Weight of the squared difference of neighbouring nodes, which keeps nodes alike where footprints are few.
const SMOOTHNESS: f64 = 2.0;

/// A footprint, and the parameters by which the tables are read.
struct Case {
    family: Family,
    reference: Reference,
    shape: Shape,
    points: [LatticePoint; 2],
    alpha: f64,
}

impl Case {
    fn draw(family: Family, random: &mut synthetic::Random) -> Self {
        let offsets = synthetic::footprint(random);
        let ratio = libm::exp2(random.range(-2.0, 5.0));
        let steepest = offsets.iter().map(|[u, v]| (u * u + v * v).sqrt()).fold(0.0, f64::max);
        let scale = (STEEPEST / steepest).min(STEEPEST * ratio);
        let alpha = scale / ratio;
        let offsets: Vec<[f64; 2]> = offsets.into_iter().map(|o| o.map(|x| x * scale)).collect();
        let weight = 1.0 / offsets.len() as f64;
        let part =
            |[u, v]: &[f64; 2]| Part { weight, normal: [-u, -v, 1.0], base: [alpha * alpha, 0.0, alpha * alpha] };
        let footprint = Footprint::new(offsets.iter().map(part).collect()).expect("there are offsets");
        let flat = |[u, v]: &[f64; 2]| ShapedMoments::normal(Moments::flat(Offset { u: *u as f32, v: *v as f32 }));
        let weights = vec![weight as f32; offsets.len()];
        let shape = Shape::of(&ShapedMoments::merge(&weights, &offsets.iter().map(flat).collect::<Vec<_>>()));
        let point = |k: usize| LatticePoint::new(shape.kurtosis[k], shape.variance[k], (alpha * alpha) as f32);
        let reference = Reference::new(family, &footprint, SAMPLES);
        Self { family, reference, shape, points: [point(0), point(1)], alpha }
    }

    fn error(&self, tables: &Tables) -> f64 {
        let (mut centre, mut a) = ([0.0; 2], [self.alpha * self.alpha, 0.0, self.alpha * self.alpha]);
        for k in 0..2 {
            let [x, y] = self.shape.axes[k].map(f64::from);
            let variance = f64::from(self.shape.variance[k]);
            let widening = 2.0 * variance * f64::from(self.points[k].interpolate(&tables[0]));
            a = [a[0] + widening * x * x, a[1] + widening * x * y, a[2] + widening * y * y];
            let shift = f64::from(self.shape.skewness[k] * self.points[k].interpolate(&tables[1])).clamp(-1.0, 1.0);
            centre = [centre[0] - shift * variance.sqrt() * x, centre[1] - shift * variance.sqrt() * y];
        }
        self.reference.error(&Lobe::new(self.family, [-centre[0], -centre[1], 1.0], a))
    }
}

/// Factor, then shift.
type Tables = [Lattice; 2];

fn main() {
    println!(
        "//! Correction factors and shifts of the centre, by deviation over alpha (1/4 to 32, a row each) and kurtosis"
    );
    println!("//! (1 to 64). Fitted and printed by `cargo run --release -p studies --bin correction_table`.");
    println!("\nuse super::lattice::Table;");
    for (name, doc, family) in FAMILIES {
        let columns = synthetic::COLUMNS.map(|(field, quantile)| (field, column(family, quantile)));
        print(name, doc, &fit(family), &columns);
    }
}

/// Fits coordinate by coordinate, with shrinking steps.
fn fit(family: Family) -> Tables {
    let mut random = synthetic::Random::new(1997);
    let cases: Vec<Case> = (0..FOOTPRINTS).map(|_| Case::draw(family, &mut random)).collect();
    let mut users = vec![Vec::new(); RATIOS * KURTOSES];
    for (index, case) in cases.iter().enumerate() {
        for point in case.points {
            for ([i, j], weight) in point.nodes() {
                let list: &mut Vec<usize> = &mut users[i * KURTOSES + j];
                if weight > 0.0 && list.last() != Some(&index) {
                    list.push(index);
                }
            }
        }
    }
    let mut tables: Tables = [[[0.6; KURTOSES]; RATIOS], [[0.1; KURTOSES]; RATIOS]];
    let mean = |tables: &Tables| cases.par_iter().map(|c| c.error(tables)).collect::<Vec<_>>().iter().sum::<f64>();
    eprintln!("{family:?}: mean lobe error at the start {:.4}", mean(&tables) / FOOTPRINTS as f64);
    for step in [0.2, 0.1, 0.05, 0.05, 0.025, 0.025, 0.0125] {
        for table in 0..2 {
            for i in 0..RATIOS {
                for j in 0..KURTOSES {
                    let users = &users[i * KURTOSES + j];
                    let cost = |tables: &Tables| {
                        let errors: Vec<f64> = users.par_iter().map(|c| cases[*c].error(tables)).collect();
                        errors.iter().sum::<f64>() + roughness_of(&tables[table], i, j)
                    };
                    let mut least = cost(&tables);
                    for direction in [step, -step] {
                        loop {
                            let mut candidates = tables;
                            candidates[table][i][j] = (candidates[table][i][j] + direction).clamp(0.0, 1.5);
                            let cost = cost(&candidates);
                            if cost >= least {
                                break;
                            }
                            (least, tables) = (cost, candidates);
                        }
                    }
                }
            }
        }
        eprintln!("steps of {step}: {:.4}", mean(&tables) / FOOTPRINTS as f64);
    }
    tables
}

/// Returns the best c at each ratio for footprints whose two axes have the distribution with these quantiles.
fn column(family: Family, quantile: fn(f64) -> f64) -> [f32; RATIOS] {
    std::array::from_fn(|i| {
        let ratio = libm::exp2(i as f64 - 2.0);
        // Samples lie closer together than the lobe is wide. Farther apart, their peaks would separate.
        let count = (4.0 * ratio).max(96.0);
        let quantiles: Vec<f64> = (0..count as u32).map(|i| quantile((f64::from(i) + 0.5) / count)).collect();
        let variance = quantiles.iter().map(|q| q * q).sum::<f64>() / count;
        let deviation = STEEPEST * ratio.min(1.0) / 4.0;
        let (scale, alpha) = (deviation / variance.sqrt(), deviation / ratio);
        let base = [alpha * alpha, 0.0, alpha * alpha];
        let parts = quantiles.iter().flat_map(|u| quantiles.iter().map(move |v| [u * scale, v * scale]));
        let parts = parts.map(|[u, v]| Part { weight: 1.0, normal: [-u, -v, 1.0], base }).collect();
        let reference = Reference::new(family, &Footprint::new(parts).expect("there are parts"), 8 * SAMPLES);
        let error = |c: f64| {
            reference.error(&Lobe::isotropic(
                family,
                [0.0, 0.0, 1.0],
                (base[0] + 2.0 * c * deviation * deviation).sqrt(),
            ))
        };
        let steps = (20..80).map(|step| 0.02 * f64::from(step));
        steps.min_by(|a, b| error(*a).total_cmp(&error(*b))).unwrap_or(1.0) as f32
    })
}

/// Returns the sum of squared differences between a node and its neighbours.
fn roughness_of(table: &Lattice, i: usize, j: usize) -> f64 {
    let neighbours = [(i.wrapping_sub(1), j), (i + 1, j), (i, j.wrapping_sub(1)), (i, j + 1)];
    let differences = neighbours.iter().filter_map(|&(k, l)| Some(table.get(k)?.get(l)? - table[i][j]));
    SMOOTHNESS * differences.map(|d| f64::from(d * d)).sum::<f64>()
}

fn print(name: &str, doc: &str, tables: &Tables, columns: &[(&str, [f32; RATIOS])]) {
    println!("\n/// {doc}\npub const {name}: Table = Table {{");
    for (field, table) in ["factor", "shift"].iter().zip(tables) {
        println!("    {field}: [");
        for row in table {
            println!("        [{}],", row.map(|v| format!("{v:.3}")).join(", "));
        }
        println!("    ],");
    }
    for (field, column) in columns {
        println!("    {field}: [{}],", column.map(|v| format!("{v:.2}")).join(", "));
    }
    println!("}};");
}
