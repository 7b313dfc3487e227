use crate::bump::Offset;
use crate::lobe::Family;
use crate::lobe::{Alpha, OrientedLobe, SquaredAlpha};
use crate::metric::*;

/// Slopes of a deviation of 0.3 with heavy tails, across grooves that change from texel to texel.
fn slope(x: u32, y: u32) -> [f32; 2] {
    let wave = (0.9 * x as f32).sin() + (0.31 * x as f32 + 0.17 * y as f32).sin();
    [0.3 * wave * wave * wave, 0.1 * (0.7 * y as f32).cos()]
}

const SIDE: u32 = 96;

fn level0(first: u32, out: &mut [OrientedLobe]) {
    for (i, lobe) in (0..).zip(out) {
        let [u, v] = slope(i % SIDE, first + i / SIDE);
        *lobe = OrientedLobe::new(Offset { u, v }, SquaredAlpha::isotropic(Alpha(0.15)));
    }
}

fn surface() -> Surface {
    let normal = |i: u32| {
        let [u, v] = slope(i % SIDE, i / SIDE).map(f64::from);
        [-u, -v, 1.0]
    };
    let normals: Vec<_> = (0..SIDE * SIDE).map(normal).collect();
    Surface::new(SIDE, SIDE, &normals, &vec![SquaredAlpha::isotropic(Alpha(0.15)); normals.len()]).unwrap()
}

/// Compares estimates from sample sites with the errors of all samples.
#[test]
fn sample_sites_agree_with_full_mean_errors() {
    let (surface, sizes) = (surface(), crate::mip::level_sizes(SIDE, SIDE));
    let sites = sample_sites(&sizes, 1..sizes.len(), Family::Ggx, Precision::QUICK, &level0);
    for (level, &size) in sizes.iter().enumerate().skip(1) {
        let lobes = |footprint: &Footprint| {
            [Peer::PlainMips, Peer::CorrectedVmf, Peer::D].map(|peer| peer.lobe(Family::Ggx, &footprint.moments()))
        };
        let of_level: Vec<_> = sites.iter().filter(|s| s.level == level).collect();
        let full =
            mean_errors(&surface, Family::Ggx, size, &sample_texels(size, usize::MAX), |_, footprint, reference| {
                lobes(footprint).map(|lobe| reference.error(&lobe))
            });
        for (i, full) in full.iter().enumerate() {
            let quick: f64 = of_level
                .iter()
                .map(|site| site.reference.error(&lobes(&surface.footprint(size, site.texel))[i]))
                .map(|error| error / of_level.len() as f64)
                .sum();
            assert!((quick - full).abs() < 0.012, "level {level}, {i}: {quick} {full}");
        }
    }
}

#[test]
fn sample_sites_do_not_depend_on_threads_and_keep_to_the_levels() {
    let sizes = crate::mip::level_sizes(SIDE, SIDE);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| sample_sites(&sizes, 2..5, Family::Ggx, Precision::QUICK, &level0))
    };
    let (one, three) = (on(1), on(3));
    assert_eq!(one.len(), three.len());
    for (a, b) in one.iter().zip(&three) {
        assert_eq!((a.level, a.texel, &a.footprint), (b.level, b.texel, &b.footprint));
        assert_eq!((a.reference.points(), a.reference.densities()), (b.reference.points(), b.reference.densities()));
    }
    assert!(one.iter().all(|s| (2..5).contains(&s.level)));
    assert!(sample_sites(&sizes, 40..50, Family::Ggx, Precision::QUICK, &level0).is_empty());
}

#[test]
fn peaks_that_the_base_lobe_blurs_count_as_one() {
    let has_two = |slopes: &[[f64; 2]], alpha: f64| {
        let base = [alpha * alpha, 0.0, alpha * alpha];
        let parts = slopes.iter().map(|[u, v]| Part { weight: 1.0, normal: [-u, -v, 1.0], base });
        is_two_peaked(Family::Ggx, &Footprint::new(parts.collect()).unwrap())
    };
    let grooves = [[0.4, 0.1], [-0.4, 0.1]];
    assert!(has_two(&grooves, 0.1));
    assert!(!has_two(&grooves, 0.9), "blurred into one");
    assert!(!has_two(&[[0.4, 0.1]], 0.1) && !has_two(&[[0.4, 0.1]; 2], 0.1));
    // Two unequal peaks along a diagonal.
    assert!(has_two(&[[0.3, 0.3], [-0.3, -0.3], [-0.3, -0.3]], 0.1));
    // A few texels of dirt are no second peak, and a row of evenly spread slopes has one peak.
    let mut dirt = vec![[0.0, 0.0]; 30];
    dirt.push([0.8, 0.0]);
    assert!(!has_two(&dirt, 0.1));
    let row: Vec<[f64; 2]> = (-20..=20).map(|i| [0.02 * f64::from(i), 0.0]).collect();
    assert!(!has_two(&row, 0.1));
    let heap: Vec<[f64; 2]> = (-20..=20).map(|i| [0.0, 0.02 * f64::from(i).powi(3) / 400.0]).collect();
    assert!(!has_two(&heap, 0.1));
}
