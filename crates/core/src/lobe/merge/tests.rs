use super::*;
use crate::bump::Offset;
use crate::lobe::family::Family;
use crate::metric;
use crate::metric::{Footprint, Lobe, Reference, oracle};

fn lobe([u, v]: [f32; 2], a: [f32; 3]) -> OrientedLobe {
    OrientedLobe::new(Offset { u, v }, SquaredAlpha(Symmetric2::new(a[0], a[1], a[2])))
}

fn merge(parts: &[OrientedLobe]) -> OrientedLobe {
    OrientedLobe::merge(&vec![1.0 / parts.len() as f32; parts.len()], parts)
}

fn assert_alike(a: OrientedLobe, b: OrientedLobe, tolerance: f32) {
    let (x, y) = (a.squared_alpha.0, b.squared_alpha.0);
    let scale = y.trace();
    for (p, q) in [(x.uu, y.uu), (x.uv, y.uv), (x.vv, y.vv)] {
        assert!((p - q).abs() <= tolerance * scale, "{a:?} is not {b:?}");
    }
    let angle = a.normal.iter().zip(b.normal).map(|(p, q)| (p - q) * (p - q)).sum::<f32>().sqrt();
    assert!(angle <= tolerance * scale.sqrt(), "{a:?} is not {b:?}");
}

/// Returns parts with slopes of three scales about a tilted mean, which need EM.
fn rough_parts() -> Vec<OrientedLobe> {
    [[0.0, 0.1], [0.3, 0.0], [-0.2, 0.4], [0.9, -0.5]].map(|o| lobe(o, [0.01, 0.002, 0.02])).to_vec()
}

#[test]
fn equal_lobes_merge_to_themselves() {
    for part in [lobe([0.0, 0.0], [0.04, 0.0, 0.04]), lobe([0.8, -1.5], [0.09, 0.02, 0.01])] {
        assert_alike(merge(&[part; 4]), part, 1e-5);
        assert_alike(merge(&[part; 25]), part, 1e-5);
    }
    // Calls EM itself, without the short cut for smooth parts.
    let part = lobe([0.5, 0.2], [0.09, 0.02, 0.04]);
    let about = frame(part.normal);
    let wide = Slopes { mean: [0.0; 2], a: Matrix { uu: 0.2, uv: 0.0, vv: 0.2 } };
    let mut memory = [[[0.0; 2]; POINTS]; 4];
    let points = half_vectors(&mut memory, &[Part::of(part.numbers()); 4], about);
    let slopes = by_points(points, wide, 3);
    assert_alike(OrientedLobe::of(tilted(about, slopes).numbers()), part, 0.01);
}

/// Takes `steps` of EM by the points of four parts.
fn by_points(points: &[[[f32; 2]; POINTS]], from: Slopes<f32>, steps: usize) -> Slopes<f32> {
    (0..steps).fold(from, |slopes, _| {
        let next = slopes.next(sums(&[0.25; 4], points, slopes));
        slopes.step(next, next)
    })
}

/// Forty more steps hardly move the lobe.
#[test]
fn the_steps_suffice() {
    let shares = [0.25; 4];
    let number = |seed: u32| {
        (seed.wrapping_mul(0x9e37_79b9) ^ (seed >> 3)).wrapping_mul(0x85eb_ca6b) as f32 / 4_294_967_808.0 - 0.5
    };
    let (mut sum, mut four, mut fewer) = (0.0, 0.0, [0.0; 2]);
    for seed in 0..400 {
        let parts = [0, 1, 2, 3].map(|i| lobe([0, 1].map(|j| number(8 * seed + 2 * i + j)), [0.04, 0.01, 0.02]));
        let parts = parts.map(|part| Part::of(part.numbers()));
        let about = frame([0.0, 0.0, 1.0]);
        let mut memory = [[[0.0; 2]; POINTS]; 4];
        let points = half_vectors(&mut memory, &parts, about);
        let start = Start::<_, 4>::of(&shares, &parts, about);
        let after = |steps| likeliest(&start, &shares, &parts, points, steps);
        let ours = after(WHOLE_STEPS);
        let end = by_points(points, ours, 40);
        let trace = end.a.uu + end.a.vv;
        let apart = |lobe: Slopes<f32>| {
            let [u, v] = [lobe.mean[0] - end.mean[0], lobe.mean[1] - end.mean[1]];
            let [uu, uv, vv] = [lobe.a.uu - end.a.uu, lobe.a.uv - end.a.uv, lobe.a.vv - end.a.vv];
            ((u * u + v * v) / trace).sqrt() + (uu * uu + uv * uv + vv * vv).sqrt() / trace
        };
        sum += apart(ours) / 400.0;
        four += apart(by_points(points, start.slopes, 4)) / 400.0;
        for (kind, fewer) in fewer.iter_mut().enumerate() {
            let mut steps = WHOLE_STEPS;
            steps[kind] -= 1;
            *fewer += apart(after(steps)) / 400.0;
        }
    }
    assert!(sum < 0.003, "{sum}");
    // The rough steps save steps by half-vectors, and every rough step is needed.
    let [before, between] = fewer;
    assert!(four > sum, "{sum}, four by the points alone {four}");
    assert!(before > 1.5 * sum && between > 3.0 * sum, "{sum}, with one step less {before} or {between}");
}

/// Bumps far smaller than the lobe add their covariance, twice.
#[test]
fn small_bumps_add_their_covariance() {
    let parts = [[0.01, 0.0], [-0.01, 0.0], [0.0, 0.005], [0.0, -0.005]].map(|o| lobe(o, [0.04, 0.0, 0.04]));
    let merged = merge(&parts);
    assert_alike(merged, lobe([0.0; 2], [0.0401, 0.0, 0.040_025]), 1e-4);
}

/// The merged lobe is hardly worse than the best one that a numerical search finds.
#[test]
fn merged_lobes_are_near_the_oracle() {
    let two_peaks = [[0.4, 0.0], [-0.4, 0.0]].map(|o| lobe(o, [0.01, 0.0, 0.01])).to_vec();
    for parts in [rough_parts(), two_peaks] {
        let f64s = |lobe: &OrientedLobe| {
            let a = lobe.squared_alpha.0;
            (lobe.normal.map(f64::from), [a.uu, a.uv, a.vv].map(f64::from))
        };
        let part = |lobe: &OrientedLobe| metric::Part { weight: 1.0, normal: f64s(lobe).0, base: f64s(lobe).1 };
        let footprint = Footprint::new(parts.iter().map(part).collect()).unwrap();
        let reference = Reference::new(Family::Ggx, &footprint, 2048);
        let (normal, a) = f64s(&merge(&parts));
        let ours = Lobe::new(Family::Ggx, normal, a);
        let (_, best) = oracle(&reference, &[ours]);
        let error = reference.error(&ours);
        assert!(error <= 1.15 * best + 0.01, "{error} where {best} is possible");
    }
}

/// Moments would make the lobe 49 times as wide in square; likelihood, four times.
#[test]
fn one_steep_texel_hardly_moves_the_lobe() {
    let flat = lobe([0.0, 0.0], [0.02, 0.0, 0.02]);
    let mut parts = vec![flat; 9];
    parts[4] = lobe([2.0, 1.0], [0.02, 0.0, 0.02]);
    let merged = merge(&parts);
    let offset = merged.offset();
    assert!(merged.squared_alpha.0.trace() < 5.0 * flat.squared_alpha.0.trace(), "{merged:?}");
    assert!(offset.u.abs() < 0.1 && offset.v.abs() < 0.1, "{merged:?}");
}

/// Mirroring the parts mirrors the lobe; so does rotating them by a right angle.
#[test]
fn merging_is_symmetric() {
    let parts = rough_parts();
    let merged = merge(&parts);
    type Map = fn(OrientedLobe) -> OrientedLobe;
    let maps: [Map; 2] = [
        |l| {
            let ([x, y, z], a) = (l.normal, l.squared_alpha.0);
            OrientedLobe { normal: [-x, y, z], squared_alpha: SquaredAlpha(Symmetric2::new(a.uu, -a.uv, a.vv)) }
        },
        |l| {
            let Offset { u, v } = l.offset();
            // A rotation of the normal does not rotate its frame alike, so the test rotates slopes about N.
            let [[t0, t1, _], [b0, b1, _], _] = frame(l.normal);
            let n = OrientedLobe::new(Offset { u: -v, v: u }, SquaredAlpha::default()).normal;
            let [rotated_t, rotated_b, _] = frame(n);
            let rotated = |x: f32, y: f32| [-y, x];
            let (t, b) = (rotated(t0, t1), rotated(b0, b1));
            let along = |axis: [f32; 3], with: [f32; 2], z: f32| axis[0] * with[0] + axis[1] * with[1] + axis[2] * z;
            let (tz, bz) = (frame(l.normal)[0][2], frame(l.normal)[1][2]);
            let j = [rotated_t, rotated_b].map(|axis| [along(axis, t, tz), along(axis, b, bz)]);
            let a = l.squared_alpha.0;
            let form =
                |p: [f32; 2], q: [f32; 2]| p[0] * q[0] * a.uu + (p[0] * q[1] + p[1] * q[0]) * a.uv + p[1] * q[1] * a.vv;
            let rotated_a = Symmetric2::new(form(j[0], j[0]), form(j[0], j[1]), form(j[1], j[1]));
            OrientedLobe { normal: n, squared_alpha: SquaredAlpha(rotated_a) }
        },
    ];
    for map in maps {
        let image = merge(&parts.iter().map(|p| map(*p)).collect::<Vec<_>>());
        // The half-vectors that represent a lobe are not symmetric themselves.
        assert_alike(image, map(merged), 0.05);
    }
}

/// The order of the parts changes only which half-vectors represent which part.
#[test]
fn order_hardly_matters() {
    let mut parts = rough_parts();
    let merged = merge(&parts);
    parts.reverse();
    assert_alike(merge(&parts), merged, 0.05);
}

#[test]
fn degenerate_parts_merge_to_finite_lobes() {
    for parts in [
        vec![lobe([0.0; 2], [0.0; 3]); 4],
        vec![lobe([16.0, 0.0], [0.0; 3]), lobe([-16.0, 0.0], [1.0, 0.0, 1.0])],
        vec![lobe([0.0, 11.0], [1.0, 1.0, 1.0]), lobe([0.0, 0.0], [1e-12, 0.0, 1e-12])],
        vec![OrientedLobe::default(); 3],
        vec![
            lobe([13.98, -7.781], [0.0622, -0.0886, 0.9916]),
            lobe([15.81, 2.442], [0.452, 0.4977, 0.548]),
            lobe([-15.54, -3.818], [0.0084, -0.0913, 0.9916]),
            lobe([-10.1, -12.41], [1.0, 0.0, 1.0]),
        ],
    ] {
        let merged = merge(&parts);
        let a = merged.squared_alpha.0;
        assert!(merged.normal[2] >= 0.0, "{merged:?}");
        assert!(merged.normal.iter().chain(&[a.uu, a.uv, a.vv]).all(|x| x.is_finite()), "{merged:?}");
        assert!(a.uu >= 0.0 && a.vv >= 0.0 && a.uu * a.vv - a.uv * a.uv >= -1e-6 * a.trace() * a.trace());
    }
}
