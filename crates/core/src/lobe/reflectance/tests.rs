use super::*;

/// Returns the cosine-weighted mean over directions of the luminance of a surface, per channel and in double precision.
fn oracle(metalness: f64, base_colour: [f64; 3], dielectric_f0: [f64; 3], specular: f64) -> f64 {
    const STEPS: usize = 20_000;
    let steps = (0..STEPS).map(|i| (i as f64 + 0.5) / STEPS as f64);
    let at = |cosine: f64| -> f64 {
        let schlick = |f0: f64, f90: f64| f0 + (f90 - f0) * (1.0 - cosine).powi(5);
        let of_channel = |i: usize| {
            let dielectric = schlick(specular * dielectric_f0[i], specular);
            (1.0 - metalness) * dielectric + metalness * schlick(base_colour[i], 1.0)
        };
        [0.2126, 0.7152, 0.0722].iter().enumerate().map(|(i, weight)| weight * of_channel(i)).sum()
    };
    steps.map(|cosine| 2.0 * cosine * at(cosine)).sum::<f64>() / STEPS as f64
}

#[test]
fn reflectance_is_the_integral_of_schlick_over_directions() {
    let colours = [[0.0; 3], [1.0; 3], [0.95, 0.64, 0.54], [0.02, 0.3, 0.7]];
    for metalness in [0.0, 0.25, 1.0] {
        for base_colour in colours {
            for dielectric_f0 in [[0.04; 3], [0.01, 0.04, 0.08]] {
                for specular in [0.1, 0.5, 1.0] {
                    let surface = MaterialTexel {
                        metalness,
                        metal_f0: luminance(base_colour),
                        dielectric_f0: luminance(dielectric_f0),
                        specular,
                    };
                    let wide = |colour: [f32; 3]| colour.map(f64::from);
                    let truth = oracle(metalness.into(), wide(base_colour), wide(dielectric_f0), specular.into());
                    let found = f64::from(surface.reflectance());
                    assert!((found - truth).abs() < 1e-5, "{surface:?}: {found} {truth}");
                }
            }
        }
    }
}

#[test]
fn dielectrics_and_metals_have_the_values_of_hand() {
    let surface = MaterialTexel { metalness: 0.0, metal_f0: 0.9, dielectric_f0: DIELECTRIC_F0, specular: 1.0 };
    assert!((surface.reflectance() - (0.04 + 0.96 / 21.0)).abs() < 1e-6);
    let metal = MaterialTexel { metalness: 1.0, ..surface };
    assert!((metal.reflectance() - (0.9 + 0.1 / 21.0)).abs() < 1e-6);
}

#[test]
fn numbers_outside_of_their_range_give_a_reflectance_above_0() {
    for number in [-1e30, -1.0, 0.0, 2.0, 65504.0] {
        let surface = MaterialTexel { metalness: number, metal_f0: number, dielectric_f0: number, specular: number };
        let reflectance = surface.reflectance();
        assert!((LEAST_REFLECTANCE..=1.0).contains(&reflectance), "{number}: {reflectance}");
    }
}
