//! Cases with known answers.

use crate::image::{Image, Samples};
use crate::lobe::Family;
use crate::lobe::{Alpha, SquaredAlpha, isotropic_distance, shape_distance};
use crate::math::vector::{dot, normalised};
use crate::metric::*;

const FAMILIES: [Family; 2] = [Family::Ggx, Family::Beckmann];
const UP: [f64; 3] = [0.0, 0.0, 1.0];

fn isotropic(alpha: f64) -> [f64; 3] {
    [alpha * alpha, 0.0, alpha * alpha]
}

/// Returns a footprint of texels of equal area with these slopes.
fn footprint(slopes: &[[f64; 2]], base: [f64; 3]) -> Footprint {
    let parts = slopes.iter().map(|[u, v]| Part { weight: 1.0, normal: [-u, -v, 1.0], base });
    Footprint::new(parts.collect()).unwrap()
}

fn error(family: Family, footprint: &Footprint, lobe: &Lobe) -> f64 {
    Reference::new(family, footprint, SAMPLES).error(lobe)
}

/// Returns a footprint of normally distributed slopes about (u, 0). They lie on a lattice of half a deviation, up to 6
/// deviations: sums over such a lattice equal integrals to many digits. With a deviation of 0 the lattice is a line.
fn normal_footprint(u: f64, deviations: [f64; 2], base: [f64; 3]) -> Footprint {
    let lattice = |deviation: f64| {
        let steps = if deviation > 0.0 { 12 } else { 0 };
        (-steps..=steps).map(move |i| {
            let x = 0.5 * f64::from(i);
            (libm::exp(-0.5 * x * x), deviation * x)
        })
    };
    let across: Vec<(f64, f64)> = lattice(deviations[1]).collect();
    let parts = lattice(deviations[0]).flat_map(|(weight, x)| {
        across.iter().map(move |(w, y)| Part { weight: weight * w, normal: [-u - x, -y, 1.0], base })
    });
    Footprint::new(parts.collect()).unwrap()
}

/// The sum in single precision is right for whole batches of points and for a shorter last one.
#[test]
fn densities_sum_all_lobes() {
    for family in FAMILIES {
        let footprint = footprint(&[[0.4, 0.0], [-0.3, 0.2], [3.0, -0.1]], [0.02, 0.01, 0.09]);
        let reference = Reference::new(family, &footprint, 70);
        assert_eq!(reference.densities().len(), 70);
        for (h, found) in reference.points().iter().zip(reference.densities()) {
            let weighted = |p: &Part| p.weight * Lobe::new(family, p.normal, p.base).density(*h);
            let expected: f64 = footprint.parts().iter().map(weighted).sum();
            assert!((found / expected - 1.0).abs() < 1e-5, "{family:?}: {found} for {expected}");
        }
    }
}

/// The lobe error is a distance only because both densities integrate to 1.
#[test]
fn densities_integrate_to_one() {
    let tilted = normalised([0.5, -0.3, 0.6]);
    for family in FAMILIES {
        for a in [isotropic(1.0), isotropic(0.3), [0.5, 0.2, 0.1]] {
            let lobe = Lobe::new(family, tilted, a);
            let (rings, steps) = (1000, 500);
            let mut sum = 0.0;
            for ring in 0..rings {
                let z: f64 = 2.0 * (f64::from(ring) + 0.5) / f64::from(rings) - 1.0;
                let r = (1.0 - z * z).sqrt();
                for step in 0..steps {
                    let phi = std::f64::consts::TAU * f64::from(step) / f64::from(steps);
                    sum += lobe.density([r * phi.cos(), r * phi.sin(), z]);
                }
            }
            let integral = sum * 2.0 * std::f64::consts::TAU / f64::from(rings * steps);
            assert!((integral - 1.0).abs() < 2e-3, "{family:?} {a:?}: {integral}");
        }
    }
}

/// The share of samples in a region is the integral of the density there.
#[test]
fn samples_follow_the_density() {
    for family in FAMILIES {
        let lobe = Lobe::new(family, [0.4, 0.1, 0.8], [0.3, 0.1, 0.08]);
        let inside = |h: [f64; 3]| h[0] > 0.2 && h[1] < 0.3;
        let n = 20_000;
        let drawn = (0..n).filter(|i| inside(lobe.sample(reference::even_point(*i)))).count() as f64 / n as f64;
        let (rings, steps) = (800, 800);
        let mut integral = 0.0;
        for ring in 0..rings {
            let z: f64 = 2.0 * (f64::from(ring) + 0.5) / f64::from(rings) - 1.0;
            let r = (1.0 - z * z).sqrt();
            for step in 0..steps {
                let phi = std::f64::consts::TAU * (f64::from(step) + 0.5) / f64::from(steps);
                let h = [r * phi.cos(), r * phi.sin(), z];
                integral += if inside(h) { lobe.density(h) } else { 0.0 };
            }
        }
        integral *= 2.0 * std::f64::consts::TAU / f64::from(rings * steps);
        assert!((drawn - integral).abs() < 4e-3, "{family:?}: {drawn} {integral}");
    }
}

#[test]
fn a_lobe_has_no_error_for_itself() {
    for family in FAMILIES {
        let one = footprint(&[[0.3, -0.2]], [0.04, 0.01, 0.02]);
        assert!(error(family, &one, &Lobe::new(family, one.parts()[0].normal, [0.04, 0.01, 0.02])) < 1e-5);
    }
}

/// Concentric GGX lobes have the closed forms of `lobe::distance`.
#[test]
fn concentric_lobes_have_the_closed_form_distance() {
    let narrow = footprint(&[[0.2, 0.1]], isotropic(0.1));
    for alpha in [0.05, 0.11, 0.3, 1.0] {
        let exact = f64::from(isotropic_distance(Alpha(0.1), Alpha(alpha as f32)));
        let found = error(Family::Ggx, &narrow, &Lobe::isotropic(Family::Ggx, narrow.parts()[0].normal, alpha));
        assert!((exact - found).abs() < 1e-3, "{alpha}: {exact} {found}");
    }
    for ratio in [1.5, 4.0, 16.0] {
        let (sin, cos) = 0.7f64.sin_cos();
        let (major, minor) = (0.04 * ratio, 0.04 / ratio);
        let a =
            [major * cos * cos + minor * sin * sin, (major - minor) * sin * cos, major * sin * sin + minor * cos * cos];
        let exact = f64::from(shape_distance(ratio as f32));
        let found = error(Family::Ggx, &footprint(&[[0.0, 0.0]], a), &Lobe::isotropic(Family::Ggx, UP, 0.2));
        assert!((exact - found).abs() < 1e-3, "{ratio}: {exact} {found}");
    }
}

/// A lobe on one of two normals that are far apart misses the other half. Beckmann lobes over slopes overlap by
/// erfc(d / (2 alpha)) at a distance of d. With small slopes, this also holds for half-vectors.
#[test]
fn a_lobe_on_one_of_two_delta_normals_misses_the_other() {
    for (slope, alpha) in [(0.05, 0.005), (0.01, 0.01), (0.005, 0.02)] {
        let two = footprint(&[[slope, 0.0], [-slope, 0.0]], isotropic(alpha));
        let one = Lobe::isotropic(Family::Beckmann, two.parts()[0].normal, alpha);
        let exact = 0.5 * libm::erf(slope / alpha);
        let found = error(Family::Beckmann, &two, &one);
        assert!((exact - found).abs() < 2e-3, "{slope} {alpha}: {exact} {found}");
    }
    // The best single lobe for two that do not overlap covers one of them, or is as bad.
    let apart = footprint(&[[0.2, 0.0], [-0.2, 0.0]], isotropic(0.01));
    let (_, best) = oracle(&Reference::new(Family::Beckmann, &apart, SAMPLES), &[]);
    assert!((0.45..=0.501).contains(&best), "{best}");
}

/// With normally distributed slopes under Beckmann, alpha'^2 = alpha^2 + 2 sigma^2 is exact, also for anisotropic
/// lobes.
#[test]
fn roughening_by_normal_slopes_under_beckmann_is_exact() {
    for [u, v] in [[0.02, 0.02], [0.03, 0.01]] {
        let alpha = 0.02;
        let bumpy = normal_footprint(0.0, [u, v], isotropic(alpha));
        let roughened =
            Lobe::new(Family::Beckmann, UP, [alpha * alpha + 2.0 * u * u, 0.0, alpha * alpha + 2.0 * v * v]);
        let found = error(Family::Beckmann, &bumpy, &roughened);
        assert!(found < 2e-3, "{found}");
        // The lobe is wrong without the factor of 2.
        let half = Lobe::new(Family::Beckmann, UP, [alpha * alpha + u * u, 0.0, alpha * alpha + v * v]);
        assert!(error(Family::Beckmann, &bumpy, &half) > 0.1);
        for peer in [Peer::D, Peer::LeanFloat] {
            assert!(error(Family::Beckmann, &bumpy, &peer.lobe(Family::Beckmann, &bumpy.moments())) < 2e-3);
        }
    }
}

/// A square of slopes with half-edge a, under a Beckmann lobe whose peak is lower than the square: the lobe misses
/// what lies beyond the square, 1 - erf(a / alpha)^2.
#[test]
fn a_uniform_square_has_the_closed_form_error() {
    let (half_edge, n) = (0.05, 48);
    let at = |i: i32| half_edge * (2.0 * (f64::from(i) + 0.5) / f64::from(n) - 1.0);
    let slopes: Vec<[f64; 2]> = (0..n).flat_map(|i| (0..n).map(move |j| [at(i), at(j)])).collect();
    // Base lobes are as wide as the lattice's step: the square has soft edges of 1/24 of its width.
    let square = footprint(&slopes, isotropic(2.0 * half_edge / f64::from(n)));
    for ratio in [1.2, 2.0, 4.0] {
        let exact = 1.0 - libm::erf(1.0 / ratio) * libm::erf(1.0 / ratio);
        let lobe = Lobe::isotropic(Family::Beckmann, UP, ratio * half_edge);
        let found = error(Family::Beckmann, &square, &lobe);
        assert!((exact - found).abs() < 0.02, "{ratio}: {exact} {found}");
    }
}

/// Footprints range from flat to two-peaked and heavy-tailed.
#[test]
fn doubling_the_samples_changes_little() {
    let ridge: Vec<[f64; 2]> = (0..64).map(|i| [if i % 2 == 0 { 0.4 } else { -0.4 }, 0.003 * f64::from(i)]).collect();
    let spike: Vec<[f64; 2]> = (0..256).map(|i| if i < 3 { [0.8, 0.2 * f64::from(i)] } else { [0.0, 0.0] }).collect();
    for family in FAMILIES {
        for alpha in [0.05, 0.4] {
            let base = isotropic(alpha);
            let shapes = [footprint(&[[0.1, 0.2]], base), footprint(&ridge, base), footprint(&spike, base)];
            let normal = [[0.2, 0.05], [0.1, 0.1]].map(|s| normal_footprint(0.1, s, base));
            for footprint in shapes.iter().chain(&normal) {
                let (once, twice) =
                    (Reference::new(family, footprint, SAMPLES), Reference::new(family, footprint, 2 * SAMPLES));
                let moments = footprint.moments();
                for peer in [Peer::PlainMips, Peer::Ea, Peer::D] {
                    let lobe = peer.lobe(family, &moments);
                    let (a, b) = (once.error(&lobe), twice.error(&lobe));
                    assert!((a - b).abs() < 0.002, "{family:?} {alpha} {peer:?}: {a} {b}");
                }
            }
        }
    }
}

#[test]
fn the_oracle_finds_a_single_lobe() {
    for family in FAMILIES {
        let a = [0.05, 0.02, 0.03];
        let one = footprint(&[[0.3, -0.1]], a);
        let (lobe, error) = oracle(&Reference::new(family, &one, SAMPLES), &[]);
        assert!(error < 0.01, "{family:?}: {error}");
        assert!(dot(lobe.normal(), one.parts()[0].normal) > 0.9999);
        for (found, expected) in lobe.squared_alpha().iter().zip(a) {
            assert!((found - expected).abs() < 0.002, "{lobe:?}");
        }
    }
}

#[test]
fn nothing_is_better_than_the_oracle() {
    for sigma in [[0.3, 0.02], [0.1, 0.1], [0.01, 0.05]] {
        let bumpy = normal_footprint(0.0, sigma, isotropic(0.1));
        let reference = Reference::new(Family::Ggx, &bumpy, SAMPLES);
        let (_, best) = oracle(&reference, &[]);
        let moments = bumpy.moments();
        for peer in Peer::ALL {
            let found = reference.error(&peer.lobe(Family::Ggx, &moments));
            assert!(best <= found + 1e-3, "{sigma:?} {peer:?}: {best} {found}");
        }
        // The result is no worse than a given start.
        let start = Peer::D.lobe(Family::Ggx, &moments);
        assert!(oracle(&reference, &[start]).1 <= reference.error(&start));
    }
}

/// Values for isotropic normal slopes of deviation sigma on base roughness r, evaluated from the peers' sources.
#[test]
fn peers_follow_their_formulas() {
    let table = [(0.1, 0.1, [0.372, 0.314, 0.171, 0.131, 0.377]), (0.3, 0.2, [0.526, 0.457, 0.401, 0.341, 0.545])];
    for (r, sigma, expected) in table {
        let moments = normal_footprint(0.0, [sigma; 2], isotropic(r * r)).moments();
        let peers = [Peer::Unreal, Peer::Ea, Peer::Filament, Peer::Godot];
        for (peer, expected) in peers.into_iter().zip(expected) {
            let found = peer.roughness(r, moments.length());
            assert!((found - expected).abs() < 1.5e-3, "{peer:?}: {found} {expected}");
        }
        // The reference is (r^4 + 2 sigma^2)^(1/4). The slope peers meet it exactly, and vMF to first order.
        for (peer, bound) in [(Peer::Lambda1, 1.5e-3), (Peer::D, 1.5e-3), (Peer::CorrectedVmf, 0.016)] {
            let [a2, _, _] = peer.lobe(Family::Ggx, &moments).squared_alpha();
            assert!((a2.sqrt().sqrt() - expected[4]).abs() < bound, "{peer:?}: {a2}");
        }
    }
    // Toksvig with R = 1/2 and s = 6 (alpha^2 = 1/4): ft = 0.5 / (0.5 + 3) = 1/7, s' = 6/7, alpha'^2 = 0.7.
    let r = 0.25f64.sqrt().sqrt();
    assert!((Peer::Toksvig.roughness(r, 0.5) - 0.7f64.sqrt().sqrt()).abs() < 1e-12);
    // Unreal's composite is Toksvig's formula less a bias.
    assert!((Peer::Unreal.roughness(r, 0.5) - 0.7f64.sqrt().sqrt()).abs() < 1e-4);
}

#[test]
fn peers_survive_degenerate_footprints() {
    let opposite: [[f64; 3]; 2] = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]];
    let parts = opposite.map(|normal| Part { weight: 1.0, normal, base: [0.0; 3] });
    for footprint in [footprint(&[[0.0, 0.0]], [0.0; 3]), Footprint::new(parts.to_vec()).unwrap()] {
        for peer in Peer::ALL {
            let reference = Reference::new(Family::Ggx, &footprint, 64);
            let found = reference.error(&peer.lobe(Family::Ggx, &footprint.moments()));
            assert!((0.0..=1.0).contains(&found), "{peer:?}: {found}");
        }
    }
    assert_eq!(Footprint::new(Vec::new()), None);
}

/// A mean slope of 1 with a deviation of 0.01 loses all of its variance in half floats, and 4.5 % in single floats.
#[test]
fn lean_moments_cancel_in_half_floats() {
    let moments = normal_footprint(1.0, [0.01, 0.0], isotropic(0.01)).moments();
    let added = |peer: Peer| peer.lobe(Family::Ggx, &moments).squared_alpha()[0] - 1e-4;
    let exact = 2.0 * moments.covariance[0];
    assert!((added(Peer::D) / exact - 1.0).abs() < 1e-6);
    assert!((added(Peer::LeanHalf) / exact - 1.0).abs() > 0.5);
    assert!((added(Peer::LeanFloat) / exact - 1.0).abs() < 0.05);
}

#[test]
fn footprints_share_texels_by_area() {
    let base = [SquaredAlpha::isotropic(Alpha(0.1)); 15];
    let normals: Vec<[f64; 3]> = (0..15).map(|i| [0.01 * f64::from(i), 0.0, 1.0]).collect();
    let surface = Surface::new(5, 3, &normals, &base).unwrap();
    // 5 columns on 2 texels are 2.5 for each; 3 rows on 1 texel are all rows.
    let left = surface.footprint((2, 1), (0, 0));
    let weights: Vec<f64> = left.parts().iter().map(|p| p.weight).collect();
    let row = [0.4 / 3.0, 0.4 / 3.0, 0.2 / 3.0];
    assert!(weights.iter().zip(row.iter().cycle()).all(|(w, e)| (w - e).abs() < 1e-15), "{weights:?}");
    for (size, texel) in [((5, 3), (4, 2)), ((3, 2), (1, 1)), ((8, 4), (7, 3)), ((1, 1), (9, 9))] {
        let footprint = surface.footprint(size, texel);
        assert!((footprint.parts().iter().map(|p| p.weight).sum::<f64>() - 1.0).abs() < 1e-15);
    }
    assert_eq!(surface.footprint((5, 3), (4, 2)).parts().len(), 1);
    assert!(Surface::new(5, 4, &normals, &base).is_none());
}

#[test]
fn texels_decode_as_engines_read_them() {
    let image = |channels, texel: &[u8]| Image { width: 1, height: 1, channels, samples: Samples::U8(texel.to_vec()) };
    let mut decoded = Decoded {
        normal: image(3, &[255, 128, 128]),
        roughness: Some(image(3, &[9, 51, 9])),
        roughness_factor: 0.5,
        // 45 degrees, full strength: alpha_t is 1.
        anisotropy: Some(image(3, &[255, 255, 255])),
    };
    let lobe = decoded.lobe(Family::Ggx, 0, 0).unwrap();
    assert!(lobe.normal()[0] > 0.9999);
    // alpha_b = (0.2 * 0.5)^2 = 0.01.
    let [uu, uv, vv] = lobe.squared_alpha();
    let (mean, half) = (0.5 * (1.0 + 1e-4), 0.5 * (1.0 - 1e-4));
    assert!((uu - mean).abs() < 1e-6 && (vv - mean).abs() < 1e-6 && (uv - half).abs() < 1e-6, "{uu} {uv} {vv}");
    decoded.anisotropy = None;
    decoded.normal = image(2, &[204, 128]);
    let lobe = decoded.lobe(Family::Ggx, 0, 0).unwrap();
    assert!((lobe.normal()[0] - 0.6).abs() < 1e-5 && (lobe.normal()[2] - 0.8).abs() < 1e-4);
    assert!((lobe.squared_alpha()[0] - 1e-4).abs() < 1e-8);
    assert!(decoded.lobe(Family::Ggx, 1, 0).is_none());
}

#[test]
fn sampled_texels_are_spread_and_inside_the_level() {
    assert_eq!(sample_texels((3, 2), 6).len(), 6);
    let many = sample_texels((100, 7), 50);
    assert_eq!(many.len(), 50);
    assert!(many.iter().all(|(x, y)| *x < 100 && *y < 7));
    assert!((0..10).all(|tenth| many.iter().any(|(x, _)| x / 10 == tenth)));
}

/// Anisotropic lobes, of which one alpha may be 0, keep their shape.
#[test]
fn a_base_lobe_survives_the_way_to_roughness_and_back() {
    for base in [[0.04, 0.0, 0.04], [1.0, 0.0, 0.0], [0.3, 0.1, 0.05], [0.0; 3]] {
        let back = base_of_roughness(roughness_of_base(base));
        assert!(back.iter().zip(base).all(|(a, b)| (a - b).abs() < 1e-12), "{back:?} {base:?}");
    }
    let mean = [0.04_f64, 0.36].map(|a| roughness_of_base([a, 0.0, a])[0]).iter().sum::<f64>() / 2.0;
    assert!((mean - 0.5 * (0.04_f64.powf(0.25) + 0.36_f64.powf(0.25))).abs() < 1e-12);
}
