use super::*;
use crate::math::vector::normalised;
use crate::render::draw::light_of_lamp;
use crate::render::{Environment, EnvironmentFilter, Point, Reflection, SceneName, Shader, Surroundings};

const SHADER: Shader = Shader { reflection: Reflection::Ggx, filter: EnvironmentFilter::Ellipse, f0: 0.9 };

/// Returns the relative difference of `found` and `expected`, of numbers of at least 0.01.
fn off(found: f64, expected: f64) -> f64 {
    (found - expected).abs() / expected.abs().max(0.01)
}

/// Returns number `i` of a sequence between 0 and 1.
fn between(i: u32, step: f64) -> f64 {
    (f64::from(i) * step).fract()
}

/// Returns a bump: every fourth one is flat, every seventh lies along T, and some face away from the eye.
fn bump(i: u32) -> Point {
    let normal = match i {
        _ if i.is_multiple_of(4) => [0.0, 0.0, 1.0],
        _ if i.is_multiple_of(7) => [1.0, 0.0, 0.0],
        _ => normalised([2.0 * between(i, 0.857) - 1.0, 2.0 * between(i, 0.733) - 1.0, 0.5]),
    };
    let (wide, narrow) = (0.5 * between(i, 0.629).powi(2), 0.02 * between(i, 0.539).powi(2));
    let (sin, cos) = libm::sincos(6.3 * between(i, 0.857));
    let squared_alpha =
        [wide * cos * cos + narrow * sin * sin, (wide - narrow) * sin * cos, wide * sin * sin + narrow * cos * cos];
    Point { normal, squared_alpha }
}

/// Compares with [`crate::render::View`], the same equations in double precision for one sample.
#[test]
fn samples_are_shaded_as_views_are() {
    for name in [SceneName::Sphere, SceneName::Plane, SceneName::Lake] {
        let scene = name.scene(100, 1.0).expect("a scene");
        let even = Environment::new(Surroundings::Even(100));
        let (mut samples, mut expected) = (Vec::new(), Vec::new());
        for i in 0..2000 {
            let ray = scene.camera.ray(100.0 * between(i, 0.618), 90.0 * between(i, 0.324));
            let Some(hit) = scene.shape.hit(scene.camera.eye, ray) else { continue };
            let (point, facet) = (bump(i), [0.999 * between(i, 0.271), between(i, 0.414)]);
            let view = SHADER.view(&point, hit.to_tangent(ray).map(|c| -c));
            let reflected = |environment| view.sample_environment(facet, environment, &|d| hit.to_world(d))[0];
            let of_light = light_of_lamp(&scene, &view, &hit)[0];
            expected.push([reflected(&even), of_light, view.visible_area(), reflected(&scene.environment)]);
            samples.push(Sample {
                position: hit.position.map(|c| c as f32),
                bump: point.into(),
                at: facet.map(|c| c as f32),
            });
        }
        let mut found = vec![ShadedSample::default(); samples.len()];
        SampleShader::new(&scene, SHADER.f0).shade(&samples, &mut found);
        let mut sum = 0.0;
        for ((found, expected), sample) in found.iter().zip(&expected).zip(&samples) {
            let weight = f64::from(found.weight);
            let errors = [weight, f64::from(found.of_light), f64::from(found.area)].into_iter().zip(expected);
            assert!(errors.into_iter().all(|(a, b)| off(a, *b) < 0.01), "{found:?} {expected:?} {sample:?}");
            sum += off(weight * scene.environment.radiance(found.from.map(f64::from))[0], expected[3]);
        }
        // The surroundings have edges, at which a small difference of directions counts.
        assert!(sum / (samples.len() as f64) < 1e-3, "{name:?}: {sum}");
        assert!(samples.len() > 1000);
    }
}

#[test]
fn sine_and_cosine_are_accurate() {
    for i in 0..1000 {
        let turns = f64::from(i) / 1000.0;
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * turns);
        let found = sin_cos(turns as f32).map(f64::from);
        assert!((found[0] - sin).abs() < 5e-7 && (found[1] - cos).abs() < 5e-7, "{turns}: {found:?}");
    }
}
