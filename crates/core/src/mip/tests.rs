use crate::bump::Moments;
use crate::bump::Offset;
use crate::math::symmetric::Symmetric2;
use crate::mip::{Wrap, *};
use rayon::prelude::*;

fn level(width: u32, height: u32, seed: u64) -> Level<Moments> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut random = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 40) as f32 / (1u64 << 24) as f32 - 0.5
    };
    let texels = (0..width * height)
        // A large mean under a small spread is the hard case for variances.
        .map(|_| Moments::flat(Offset { u: 3.0 + 0.1 * random(), v: random() * random() }))
        .collect();
    Level { width, height, texels }
}

/// Computes mean and covariance of the whole level in f64: cov(m) + mean(K).
fn total(level: &Level<Moments>) -> ([f64; 2], [f64; 3]) {
    let n = level.texels.len() as f64;
    let mut mean = [0.0; 2];
    for t in &level.texels {
        mean[0] += f64::from(t.mean.u) / n;
        mean[1] += f64::from(t.mean.v) / n;
    }
    let mut k = [0.0; 3];
    for t in &level.texels {
        let (u, v) = (f64::from(t.mean.u) - mean[0], f64::from(t.mean.v) - mean[1]);
        k[0] += (f64::from(t.covariance.uu) + u * u) / n;
        k[1] += (f64::from(t.covariance.uv) + u * v) / n;
        k[2] += (f64::from(t.covariance.vv) + v * v) / n;
    }
    (mean, k)
}

fn assert_total_variance_is_kept(width: u32, height: u32) {
    let source = level(width, height, u64::from(width * 65_537 + height));
    let (mean_0, k_0) = total(&source);
    for tail in build(&source) {
        let (mean, k) = total(&tail);
        let place = (width, height, tail.width, tail.height);
        assert!((mean[0] - mean_0[0]).abs() <= 1e-5 * mean_0[0].abs(), "{place:?}");
        assert!((mean[1] - mean_0[1]).abs() <= 1e-5 * k_0[2].sqrt(), "{place:?}");
        let spread = k_0[0] + k_0[2];
        for i in 0..3 {
            assert!((k[i] - k_0[i]).abs() <= 1e-5 * spread, "{place:?}: {k:?} {k_0:?}");
        }
    }
}

#[test]
fn total_variance_is_kept_on_small_sizes() {
    (1..=17u32).into_par_iter().for_each(|height| {
        for width in 1..=17 {
            assert_total_variance_is_kept(width, height);
        }
    });
}

#[test]
fn total_variance_is_kept_on_large_sizes() {
    for (width, height) in [(745, 745), (1000, 1000), (1023, 511)] {
        assert_total_variance_is_kept(width, height);
    }
}

/// Computes the slow oracle: each texel of a level of the given size by an area integral over level 0, in f64.
fn oracle(source: &Level<Moments>, width: u32, height: u32) -> Vec<([f64; 2], [f64; 3])> {
    // The area of a coarse texel is that of its finer texels, so areas follow the polyphase boxes from level to level.
    let share = |fine: u32, coarse: u32| -> Vec<Vec<f64>> {
        let mut table: Vec<Vec<f64>> =
            (0..fine).map(|i| (0..fine).map(|j| f64::from(u8::from(i == j))).collect()).collect();
        let mut size = fine;
        while size != coarse {
            let half = level_size(size);
            let (s, h) = (f64::from(size), f64::from(half));
            table = (0..half)
                .map(|i| {
                    let (start, end) = (f64::from(i) * s / h, f64::from(i + 1) * s / h);
                    let mut row = vec![0.0; fine as usize];
                    for (j, finer) in table.iter().enumerate() {
                        let overlap = (end.min(j as f64 + 1.0) - start.max(j as f64)).max(0.0);
                        for (sum, x) in row.iter_mut().zip(finer) {
                            *sum += overlap * h / s * x;
                        }
                    }
                    row
                })
                .collect();
            size = half;
        }
        table
    };
    let (across, down) = (share(source.width, width), share(source.height, height));
    let mut out = Vec::new();
    for wy in &down {
        for wx in &across {
            let weight = |i: usize| wx[i % source.width as usize] * wy[i / source.width as usize];
            let mut mean = [0.0; 2];
            for (i, t) in source.texels.iter().enumerate() {
                mean[0] += weight(i) * f64::from(t.mean.u);
                mean[1] += weight(i) * f64::from(t.mean.v);
            }
            let mut k = [0.0; 3];
            for (i, t) in source.texels.iter().enumerate() {
                let (u, v) = (f64::from(t.mean.u) - mean[0], f64::from(t.mean.v) - mean[1]);
                k[0] += weight(i) * u * u;
                k[1] += weight(i) * u * v;
                k[2] += weight(i) * v * v;
            }
            out.push((mean, k));
        }
    }
    out
}

#[test]
fn every_texel_matches_the_oracle() {
    let small = [(1, 1), (2, 2), (3, 3), (5, 4), (7, 1), (1, 9), (13, 17), (16, 16), (17, 6)];
    // High enough for several levels in one pass.
    for (width, height) in small.into_iter().chain([(34, 256), (4, 512)]) {
        let source = level(width, height, 7);
        for tail in build(&source) {
            let expected = oracle(&source, tail.width, tail.height);
            for (t, (mean, k)) in tail.texels.iter().zip(expected) {
                assert!((f64::from(t.mean.u) - mean[0]).abs() < 2e-6 * 3.0);
                assert!((f64::from(t.mean.v) - mean[1]).abs() < 1e-6);
                let bound = 2e-5 * (k[0] + k[2]) + 1e-9;
                assert!((f64::from(t.covariance.uu) - k[0]).abs() < bound, "{t:?} {k:?}");
                assert!((f64::from(t.covariance.uv) - k[1]).abs() < bound, "{t:?} {k:?}");
                assert!((f64::from(t.covariance.vv) - k[2]).abs() < bound, "{t:?} {k:?}");
            }
        }
    }
}

#[test]
fn covariances_are_positive_semidefinite() {
    for tail in build(&level(61, 37, 3)) {
        for t in &tail.texels {
            let k = t.covariance;
            assert!(k.uu >= 0.0 && k.vv >= 0.0);
            assert!(k.uv * k.uv <= k.uu * k.vv * (1.0 + 1e-5), "{k:?}");
        }
    }
}

/// Rotating the map by 90 degrees rotates means and covariances; mirroring the map mirrors them.
#[test]
fn pyramids_rotate_and_mirror_with_their_map() {
    let source = level(12, 12, 5);
    let rotated = Level {
        texels: (0..144)
            .map(|i| {
                let t = source.texels[(i % 12) * 12 + 11 - i / 12];
                Moments::flat(Offset { u: -t.mean.v, v: t.mean.u })
            })
            .collect(),
        ..source.clone()
    };
    for (a, b) in build(&source).iter().zip(build(&rotated)) {
        let n = a.width as usize;
        for i in 0..n * n {
            let (a, b) = (a.texels[(i % n) * n + n - 1 - i / n], b.texels[i]);
            let expected = Symmetric2::new(a.covariance.vv, -a.covariance.uv, a.covariance.uu);
            for (x, y) in [
                (expected.uu, b.covariance.uu),
                (expected.uv, b.covariance.uv),
                (expected.vv, b.covariance.vv),
                (-a.mean.v, b.mean.u),
                (a.mean.u, b.mean.v),
            ] {
                assert!((x - y).abs() <= 1e-6 * (1.0 + x.abs()), "{a:?} {b:?}");
            }
        }
    }
}

#[test]
fn bits_do_not_depend_on_threads() {
    // One level in a pass, and four.
    for (width, height) in [(255, 130), (36, 1024)] {
        let source = level(width, height, 11);
        let with_threads =
            |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| build(&source));
        let one = with_threads(1);
        assert_eq!(one, with_threads(2));
        assert_eq!(one, with_threads(7));
    }
}

/// Why K is carried and not E[x^2] - E[x]^2: at slope 3 with a deviation of 0.0005, the difference of f32 moments has
/// lost its digits while the recursion keeps them.
#[test]
fn moment_subtraction_cancels_and_the_recursion_does_not() {
    let width = 64u32;
    let mut source = level(width, width, 17);
    for t in &mut source.texels {
        t.mean = Offset { u: 3.0 + 0.01 * (t.mean.u - 3.0), v: 0.0 };
    }
    let truth = total(&source).1[0];
    let recursion = f64::from(build(&source).last().unwrap().texels[0].covariance.uu);
    let moments =
        Level { width, height: width, texels: source.texels.iter().map(|t| [t.mean.u, t.mean.u * t.mean.u]).collect() };
    let [mean, square] = build(&moments).last().unwrap().texels[0];
    let subtraction = f64::from(square - mean * mean);
    assert!((recursion - truth).abs() < 1e-4 * truth, "{recursion} {truth}");
    assert!((subtraction - truth).abs() > 0.3 * truth, "{subtraction} {truth}");
}

fn rows<R: TexelRows>(source: &R) -> Level<R::Texel> {
    let (width, height) = (source.width(), source.height());
    let mut texels = vec![R::Texel::default(); (width * height) as usize];
    for (y, row) in texels.chunks_exact_mut(width as usize).enumerate() {
        source.row(y as u32, row);
    }
    Level { width, height, texels }
}

#[test]
fn resampling_by_area_keeps_total_variance() {
    for (from, to) in
        [((745, 5), (748, 8)), ((7, 7), (4, 12)), ((32, 32), (64, 16)), ((5, 3), (5, 3)), ((1, 1), (4, 4))]
    {
        let source = level(from.0, from.1, 2);
        let resampled = rows(&AreaResampled::new(source.clone(), to.0, to.1));
        let ((m0, k0), (m1, k1)) = (total(&source), total(&resampled));
        for i in 0..2 {
            assert!((m0[i] - m1[i]).abs() < 1e-6 * 3.0, "{from:?} {to:?}");
        }
        for i in 0..3 {
            assert!((k0[i] - k1[i]).abs() < 2e-5 * (k0[0] + k0[2]) + 1e-12, "{from:?} {to:?} {k0:?} {k1:?}");
        }
    }
}

#[test]
fn resampling_to_an_equal_size_keeps_all_bits() {
    let source = level(9, 6, 4);
    assert_eq!(rows(&AreaResampled::new(source.clone(), 9, 6)), source);
    assert_eq!(rows(&LinearResampled::new(source.clone(), 9, 6, [Wrap::Repeat; 2])), source);
}

#[test]
fn magnifying_interpolates_between_centres() {
    let source = Level { width: 2, height: 1, texels: vec![[0.0_f32], [1.0]] };
    let magnified = |wrap| {
        let rows = rows(&LinearResampled::new(source.clone(), 4, 1, [wrap; 2]));
        rows.texels.iter().map(|t| t[0]).collect::<Vec<f32>>()
    };
    assert_eq!(magnified(Wrap::Clamp), [0.0, 0.25, 0.75, 1.0]);
    assert_eq!(magnified(Wrap::Mirror), [0.0, 0.25, 0.75, 1.0]);
    // Across the seam, the neighbour of the first texel is the last.
    assert_eq!(magnified(Wrap::Repeat), [0.25, 0.25, 0.75, 0.75]);
}

#[test]
fn mip_chains_end_at_one_texel() {
    assert_eq!(level_sizes(5, 2), [(5, 2), (2, 1), (1, 1)]);
    assert_eq!(level_sizes(1, 1), [(1, 1)]);
}

#[test]
fn unkept_levels_equal_kept_levels() {
    for (width, height) in [(64, 32), (37, 23), (1, 40), (50, 1), (1, 1), (9, 512)] {
        let source = level(width, height, 3);
        let all = build(&source);
        for most in [0, 1, 100, 300] {
            let some = MipTail::with_max_kept(&source, most);
            for (level, expected) in [&source].into_iter().chain(&all).enumerate() {
                let mut found = vec![Moments::default(); expected.texels.len()];
                for (y, row) in found.chunks_exact_mut(expected.width as usize).enumerate() {
                    some.row(&source, level, y as u32, row);
                }
                assert_eq!(found, expected.texels, "{width} x {height}, {most}");
            }
        }
    }
}
