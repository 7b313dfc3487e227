//! Compares the metric of normals with its definition in f64, and with squared differences of channels.

use super::decode::{every_mode, expected};
use super::*;
use crate::blocks::Blocks;
use crate::direction::{
    LONG_PENALTY, REBUILT_Z_SHARE, Refinement, SHORT_PENALTY, SquaredDistances, normals as unit_normals,
};
use crate::hints::Hints;
use crate::lanes::channels;
use crate::pack::Block;
use fearless_simd::Level;
use texel_simd::{LANES, dispatch};

type Vector = [f64; 3];

fn vector(texel: [u8; 4]) -> Vector {
    [0, 1, 2].map(|c| f64::from(texel[c]) / 127.5 - 1.0)
}

fn length(v: Vector) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

fn read(v: Vector) -> Vector {
    v.map(|c| c / length(v))
}

fn rebuilt([x, y, _]: Vector) -> Vector {
    [x, y, (1.0 - x * x - y * y).max(0.0).sqrt()]
}

fn difference(a: Vector, b: Vector) -> f64 {
    (0..3).map(|c| (a[c] - b[c]).powi(2)).sum()
}

/// Returns the error of one texel by the definition of the metric.
fn error(texel: [u8; 4], normal: Vector) -> f64 {
    let v = vector(texel);
    let departure = length(v) - 1.0;
    let r = f64::from(REBUILT_Z_SHARE);
    let directions = (1.0 - r) * difference(read(v), normal) + r * difference(rebuilt(v), normal);
    directions + f64::from(if departure < 0.0 { SHORT_PENALTY } else { LONG_PENALTY }) * departure * departure
}

pub(super) fn total(found: &Texels, source: &Texels) -> f64 {
    found.iter().zip(source).map(|(f, s)| error(*f, read(vector(*s)))).sum()
}

/// Returns the error of a block with the best weight of every texel, found by trying all weights.
fn least_error(block: &Block, source: &Texels) -> f64 {
    let top = 1u8 << block.mode.weight_bits;
    let second = if block.mode.planes == 2 { top } else { 1 };
    let mut least = [f64::INFINITY; 16];
    for weights in (0..top).flat_map(|a| (0..second).map(move |b| [[a; 16], [b; 16]])) {
        let found = expected(&Block { weights, ..block.clone() });
        for i in 0..16 {
            least[i] = least[i].min(error(found[i], read(vector(source[i]))));
        }
    }
    least.iter().sum()
}

fn aim(block: &mut Block, source: &Texels, rounds: usize, passes: usize) {
    dispatch!(Level::new(), simd => {
        let mut blocks = Blocks::load(simd, [&*block; LANES]);
        let normals = unit_normals(&channels(simd, [source; LANES]));
        blocks.fit_directions(simd, SquaredDistances(&normals), Refinement { rounds, hops: 0, passes });
        *block = blocks.store().block(0);
    });
}

#[test]
fn errors_equal_the_definition_and_weights_are_best() {
    let scale = 127.5 * 127.5;
    for source in normals(0.1, 16).into_iter().chain(normals(1.5, 16)).chain(all_kinds().into_iter().step_by(17)) {
        for (mode, mut block) in every_mode(&source).into_iter().step_by(7) {
            aim(&mut block, &source, 2, 1);
            let claimed = f64::from(block.error) / scale;
            let (found, least) = (expected(&block), least_error(&block, &source));
            let actual = total(&found, &source);
            assert!((claimed - actual).abs() <= 1e-4 * actual + 1e-6, "mode {mode}: {claimed} for {actual}");
            assert!(actual <= least * (1.0 + 1e-4) + 1e-6, "mode {mode}: {actual}, with other weights {least}");
            assert_eq!(decoded(&block.pack(&Hints::default())), found, "mode {mode}");
        }
    }
}

#[test]
fn more_rounds_and_passes_never_raise_the_error() {
    for source in normals(0.4, 64) {
        for (_, block) in every_mode(&source).into_iter().step_by(5) {
            let errors = [(1, 0), (2, 0), (2, 1), (2, 2)].map(|(rounds, passes)| {
                let mut block = block.clone();
                aim(&mut block, &source, rounds, passes);
                block.error
            });
            assert!(errors.is_sorted_by(|a, b| b <= a), "{errors:?}");
        }
    }
}

#[test]
fn best_is_never_worse_than_fast() {
    for source in all_kinds() {
        let [fast, best] =
            EFFORTS.map(|effort| total(&decoded(&encode_block(&source, Metric::Direction, effort)), &source));
        assert!(best <= fast * (1.0 + 1e-5) + 1e-9, "{best} over {fast} for {source:?}");
    }
}

/// Returns mean angles in degrees, for engines that normalise and for engines that rebuild z, and the mean departure
/// from unit length.
fn angles(sources: &[Texels], metric: Metric, effort: Effort) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for source in sources {
        let found = decoded(&encode_block(source, metric, effort));
        for (f, s) in found.iter().zip(source) {
            let (v, normal) = (vector(*f), read(vector(*s)));
            let angle = |d: Vector| (2.0 * (difference(d, normal).sqrt() / 2.0).min(1.0).asin()).to_degrees();
            let each = [angle(read(v)), angle(rebuilt(v)), length(v) - 1.0];
            (0..3).for_each(|k| sums[k] += each[k] / (16 * sources.len()) as f64);
        }
    }
    sums
}

#[test]
fn angles_do_not_exceed_those_of_rgb_and_lengths_are_kept() {
    // Largest ratios of the angles by direction to the angles by RGB; 0.01 above the measured ratios.
    for (noise, fast, best) in
        [(0.1, [0.99, 1.0], [0.99, 1.01]), (0.4, [1.0, 1.01], [1.0, 1.01]), (0.9, [1.01, 1.0], [1.0, 1.0])]
    {
        let sources = normals(noise, 256);
        for (effort, most) in EFFORTS.into_iter().zip([fast, best]) {
            let [before, after] = [Metric::Rgb, Metric::Direction].map(|metric| angles(&sources, metric, effort));
            let left = [after[0] / before[0], after[1] / before[1]];
            assert!(left[0] <= most[0] && left[1] <= most[1], "noise {noise}, {effort:?}: {left:.3?} of {before:.3?}");
            assert!(after[2].abs() < 0.01, "noise {noise}, {effort:?}: lengths off by {:+.4}", after[2]);
        }
    }
}

#[test]
fn exhaustive_search_gains_at_most_4_percent() {
    // The exhaustive search fits all modes, patterns and selectors, and refines each of them until nothing improves.
    let sources = normals(0.4, 12);
    let mut sums = [0.0; 2];
    for source in &sources {
        let least = every_mode(source).into_iter().map(|(_, mut block)| {
            aim(&mut block, source, 8, 8);
            f64::from(block.error) / (127.5 * 127.5)
        });
        sums[0] += least.fold(f64::INFINITY, f64::min);
        sums[1] += total(&decoded(&encode_block(source, Metric::Direction, Effort::Best)), source);
    }
    assert!(sums[1] <= 1.04 * sums[0], "squared error {:.4}, after exhaustive search {:.4}", sums[1], sums[0]);
}
