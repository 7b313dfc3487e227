use super::*;
use crate::bump::{NormalLayout, NormalMap};
use crate::image::{Samples, srgb_to_linear};
use crate::lobe::reflectance::LUMINANCE;

const SIZE: (u32, u32) = (8, 8);
const WRAP: [Wrap; 2] = [Wrap::Repeat; 2];

fn image(texel: impl Fn(u32, u32) -> [u8; 3]) -> Image {
    let bytes = (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y))).flat_map(|(x, y)| texel(x, y)).collect();
    Image { width: SIZE.0, height: SIZE.1, channels: 3, samples: Samples::U8(bytes) }
}

fn normal(x: u32, y: u32) -> [u8; 3] {
    [(60 + 37 * (x * x + 3 * y) % 140) as u8, (70 + 53 * (y * y + x) % 120) as u8, 220]
}

fn colour(x: u32, y: u32) -> [u8; 3] {
    [(30 * x) as u8, (20 + 25 * y) as u8, 90]
}

fn bumps() -> BumpMap {
    BumpMap::Normals(NormalMap::new(image(normal), NormalLayout::Xyz, false).unwrap())
}

/// Returns m + (1 - m) |mean n| of the texel (`x`, `y`) of `level`, in double precision.
fn oracle(level: u32, (x, y): (u32, u32), scale: f64, metalness: impl Fn(u32, u32) -> f64) -> f64 {
    let side = 1 << level;
    let (mut sum, mut product, mut luminance) = ([0.0; 3], 0.0, 0.0);
    for (x, y) in (0..side * side).map(|i| (side * x + i % side, side * y + i / side)) {
        let [u, v, w] = normal(x, y).map(|byte| f64::from(byte) * 2.0 / 255.0 - 1.0);
        let tilted = [scale * u, scale * v, w];
        let length = tilted.iter().map(|n| n * n).sum::<f64>().sqrt();
        sum.iter_mut().zip(tilted).for_each(|(sum, n)| *sum += n / length);
        let linear = colour(x, y).map(|byte| srgb_to_linear(f64::from(byte) / 255.0));
        let bright: f64 = linear.iter().zip(LUMINANCE).map(|(c, weight)| c * f64::from(weight)).sum();
        product += metalness(x, y) * bright;
        luminance += bright;
    }
    let length = sum.iter().map(|n| n * n).sum::<f64>().sqrt() / f64::from(side * side);
    let metalness = product / luminance;
    metalness + (1.0 - metalness) * length
}

fn check(metalness: impl Fn(u32, u32) -> u8 + Copy, factor: f32, scale: f32) {
    let (bump_map, base) = (bumps(), image(colour));
    let roughness = image(|x, y| [255, 128, metalness(x, y)]);
    let source = DiffuseSource {
        bump_map: &bump_map,
        slope_scale: scale,
        roughness: Some(&roughness),
        metalness: Metalness::new(Some(&roughness), factor),
        base_colour: Factored { image: Some(&base), factor: [1.0; 3] },
    };
    let light = DiffuseLight::new(source, SIZE, WRAP);
    assert_eq!(light.row(0, 5), [1.0; 8]);
    for level in 1..4 {
        for y in 0..SIZE.1 >> level {
            for (x, factor_found) in light.row(level as usize, y).into_iter().enumerate() {
                let metal = |x, y| f64::from(factor) * f64::from(metalness(x, y)) / 255.0;
                let expected = oracle(level, (x as u32, y), f64::from(scale), metal);
                assert!((f64::from(factor_found) - expected).abs() < 2e-5, "{level}: {factor_found}, {expected}");
            }
        }
    }
}

#[test]
fn dielectrics_lose_the_length_of_the_mean_normal() {
    check(|_, _| 0, 1.0, 1.0);
    check(|_, _| 255, 0.0, 1.0);
    check(|_, _| 0, 1.0, 0.4);
}

#[test]
fn metals_lose_nothing() {
    check(|_, _| 255, 1.0, 1.0);
}

#[test]
fn mixed_texels_count_by_the_luminance_of_their_colours() {
    check(|x, _| if x % 2 == 0 { 255 } else { 0 }, 1.0, 1.0);
    check(|x, y| (29 * x + 3 * y) as u8, 0.8, 1.5);
    check(|_, _| 128, 1.0, 1.0);
}

#[test]
fn flat_bumps_and_black_colours_lose_nothing() {
    let flat = BumpMap::Normals(NormalMap::new(image(|_, _| [128, 128, 255]), NormalLayout::Xyz, false).unwrap());
    let steep = bumps();
    let black = image(|_, _| [0; 3]);
    for (bump_map, least) in [(&flat, 0.9999), (&steep, 1.0)] {
        let source = DiffuseSource {
            bump_map,
            slope_scale: 1.0,
            roughness: None,
            metalness: Metalness::Constant(0.0),
            base_colour: Factored { image: Some(&black), factor: [1.0; 3] },
        };
        let light = DiffuseLight::new(source, SIZE, WRAP);
        assert!(light.row(3, 0)[0] >= least);
    }
}
