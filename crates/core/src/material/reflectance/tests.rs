use super::*;
use crate::image::Samples;

/// Returns an image of 4 x 2 texels whose left half has one colour and whose right half has another.
fn halves(left: [u8; 4], right: [u8; 4]) -> Image {
    let row = [left, left, right, right].concat();
    Image { width: 4, height: 2, channels: 4, samples: Samples::U8([row.clone(), row].concat()) }
}

/// A white material of constant metalness 1.
fn white_metal<'a>() -> ReflectanceSource<'a> {
    ReflectanceSource {
        roughness: None,
        metalness: Metalness::Constant(1.0),
        base_colour: Factored { image: None, factor: [1.0; 3] },
        specular: Factored { image: None, factor: 1.0 },
        specular_colour: Factored { image: None, factor: [1.0; 3] },
    }
}

fn rows<'a>(source: &ReflectanceSource<'a>) -> Option<ReflectanceRows<'a>> {
    ReflectanceRows::new(source, (4, 2), [Wrap::Clamp; 2])
}

fn row(source: &ReflectanceSource<'_>) -> [f32; 4] {
    let mut row = [0.0; 4];
    rows(source).expect("a reflectance that varies").row(1, &mut row);
    row
}

#[test]
fn metal_reflects_its_base_colour_and_rust_as_a_dielectric() {
    let (orm, colour) = (halves([0, 9, 0, 255], [0, 9, 255, 255]), halves([90, 40, 20, 255], [188, 188, 188, 255]));
    let source = ReflectanceSource {
        roughness: Some(&orm),
        metalness: Metalness::new(Some(&orm), 1.0),
        base_colour: Factored { image: Some(&colour), factor: [1.0, 0.5, 1.0] },
        ..white_metal()
    };
    let [rust, metal] = [0.04 + 0.96 / 21.0, {
        let f0 = srgb_to_linear(188.0 / 255.0) * (0.2126 + 0.5 * 0.7152 + 0.0722);
        f0 + (1.0 - f0) / 21.0
    }];
    for (found, expected) in row(&source).into_iter().zip([rust, rust, metal, metal]) {
        assert!((f64::from(found) - expected).abs() < 1e-5, "{found} {expected}");
    }
}

#[test]
fn specular_textures_decide_on_dielectrics() {
    let (specular, colour) = (halves([9, 9, 9, 51], [9, 9, 9, 255]), halves([255; 4], [0, 0, 0, 255]));
    let source = ReflectanceSource {
        metalness: Metalness::Constant(0.0),
        specular: Factored { image: Some(&specular), factor: 0.5 },
        specular_colour: Factored { image: Some(&colour), factor: [50.0; 3] },
        ..white_metal()
    };
    // F0 is at most 1 before it is multiplied by the specular factor.
    for (found, expected) in row(&source).into_iter().zip([0.1, 0.1, 0.5 / 21.0, 0.5 / 21.0]) {
        assert!((found - expected).abs() < 1e-5, "{found} {expected}");
    }
}

#[test]
fn textures_that_cannot_matter_leave_the_reflectance_constant() {
    let colour = halves([90, 40, 20, 255], [188, 188, 188, 255]);
    let varying = Factored { image: Some(&colour), factor: [1.0; 3] };
    assert!(rows(&white_metal()).is_none());
    assert!(rows(&ReflectanceSource { specular_colour: varying, ..white_metal() }).is_none());
    assert!(rows(&ReflectanceSource { base_colour: varying, ..white_metal() }).is_some());
    let dielectric = ReflectanceSource { metalness: Metalness::Constant(0.0), ..white_metal() };
    assert!(rows(&ReflectanceSource { base_colour: varying, ..dielectric }).is_none());
    assert!(rows(&ReflectanceSource { specular_colour: varying, ..dielectric }).is_some());
    let flat = halves([90, 40, 20, 255], [90, 40, 20, 255]);
    let constant = Factored { image: Some(&flat), factor: [1.0; 3] };
    assert!(rows(&ReflectanceSource { base_colour: constant, ..white_metal() }).is_none());
}

#[test]
fn metalness_ignores_the_noise_of_compression() {
    let of = |left, right, factor| Metalness::new(Some(&halves([0, 0, left, 255], [0, 0, right, 255])), factor);
    assert_eq!(of(0, 7, 1.0), Metalness::Constant(0.0));
    assert_eq!(of(0, 14, 0.5), Metalness::Constant(0.0));
    assert_eq!(of(249, 255, 1.0), Metalness::Constant(252.0 / 255.0));
    assert_eq!(of(0, 9, 1.0), Metalness::Texture(1.0));
    assert_eq!(of(0, 255, 0.0), Metalness::Constant(0.0));
    assert_eq!(Metalness::new(None, 0.7), Metalness::Constant(0.7));
    assert!(!Metalness::Constant(0.0).needs_base_colour() && Metalness::Constant(0.7).needs_base_colour());
}

/// A base colour of another size is magnified as a sampler does.
#[test]
fn smaller_textures_are_interpolated_on_the_grid() {
    let colour = Image { width: 2, height: 1, channels: 1, samples: Samples::U8(vec![0, 255]) };
    let source =
        ReflectanceSource { base_colour: Factored { image: Some(&colour), factor: [1.0; 3] }, ..white_metal() };
    for (found, f0) in row(&source).into_iter().zip([0.0, 0.25, 0.75, 1.0]) {
        assert!((found - (f0 + (1.0 - f0) / 21.0)).abs() < 1e-5, "{found} {f0}");
    }
}
