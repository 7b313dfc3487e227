use super::*;
use crate::bump::Offset;
use crate::lobe::{Alpha, SquaredAlpha};

fn texel(offset: [f32; 2], alpha: f32, reflectance: f32) -> ReflectingLobe {
    let [u, v] = offset;
    ReflectingLobe { lobe: OrientedLobe::new(Offset { u, v }, SquaredAlpha::isotropic(Alpha(alpha))), reflectance }
}

fn distance(a: &OrientedLobe, b: &OrientedLobe) -> f32 {
    a.numbers().iter().zip(b.numbers()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// Mirror steel beside rust, as two texels of each.
fn steel_and_rust() -> [ReflectingLobe; 4] {
    [
        texel([0.1, 0.0], 0.01, 0.6),
        texel([0.12, 0.02], 0.01, 0.6),
        texel([-0.3, 0.2], 0.5, 0.08),
        texel([0.2, -0.3], 0.5, 0.08),
    ]
}

#[test]
fn parts_of_equal_reflectance_merge_by_area() {
    let weights = [0.25, 0.25, 0.3, 0.2];
    let parts = steel_and_rust().map(|part| ReflectingLobe { reflectance: 0.3, ..part });
    let merged = ReflectingLobe::merge(&weights, &parts);
    let by_area = OrientedLobe::merge(&weights, &parts.map(|part| part.lobe));
    assert!(distance(&merged.lobe, &by_area) < 1e-5 && (merged.reflectance - 0.3).abs() < 1e-6);
}

#[test]
fn a_part_of_twice_the_reflectance_counts_like_twice_the_area() {
    let [a, b, c, _] = steel_and_rust();
    let bright = ReflectingLobe { reflectance: 2.0 * a.reflectance, ..a };
    let merged = ReflectingLobe::merge(&[0.25, 0.25, 0.5], &[bright, b, c]);
    let large = ReflectingLobe::merge(&[0.4, 0.2, 0.4], &[a, b, c]);
    assert!(distance(&merged.lobe, &large.lobe) < 1e-5, "{merged:?} {large:?}");
    assert!((merged.reflectance - (0.5 * 0.6 + 0.25 * 0.6 + 0.5 * 0.08)).abs() < 1e-6);
}

#[test]
fn the_merged_lobe_follows_the_metal() {
    let merged = ReflectingLobe::merge(&[0.25; 4], &steel_and_rust());
    let by_area = OrientedLobe::merge(&[0.25; 4], &steel_and_rust().map(|part| part.lobe));
    let [steel, ..] = steel_and_rust();
    let alpha = |lobe: &OrientedLobe| lobe.squared_alpha.closest_isotropic().0;
    assert!(alpha(&merged.lobe) < 0.5 * alpha(&by_area), "{} {}", alpha(&merged.lobe), alpha(&by_area));
    let tilt = |lobe: &OrientedLobe| lobe.normal[0] - steel.lobe.normal[0];
    assert!(tilt(&merged.lobe).abs() < 0.02);
    assert!((merged.reflectance - 0.34).abs() < 1e-6);
}

#[test]
fn many_parts_merge_like_few() {
    let parts = steel_and_rust().repeat(3);
    let many = ReflectingLobe::merge(&[1.0 / 12.0; 12], &parts);
    let few = ReflectingLobe::merge(&[0.25; 4], &parts[..4]);
    assert!((many.reflectance - few.reflectance).abs() < 1e-6);
    assert!(distance(&many.lobe, &few.lobe) < 0.02, "{many:?} {few:?}");
}
