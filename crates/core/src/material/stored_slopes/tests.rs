use super::*;
use crate::bump::{NormalLayout, NormalMap};
use crate::image::{Image, Samples};
use crate::material::bump_map::BumpMap;

/// Returns the scale of a map of 16 x 600 texels. In its rows the slopes are `slope`, 0 in a share of `flat` 16ths, and
/// -`slope`.
fn scale_of(slope: f32, flat: u32) -> f32 {
    let texel = |i: u32| {
        let u = match i % 16 {
            column if column < flat => 0.0,
            column if column < 8 + flat / 2 => slope,
            _ => -slope,
        };
        let length = (1.0 + u * u).sqrt();
        [0.5 + 0.5 * u / length, 0.5, 0.5 + 0.5 / length]
    };
    let samples = Samples::F32((0..16 * 600).flat_map(texel).collect());
    let image = Image { width: 16, height: 600, channels: 3, samples };
    let map = BumpMap::Normals(NormalMap::new(image, NormalLayout::Auto, false).expect("a normal map"));
    normal_scale(&Bumps::new(&map, (16, 600)))
}

#[test]
fn low_bumps_are_scaled_to_twice_their_slope() {
    for slope in [0.02, 0.2] {
        let scale = scale_of(slope, 0);
        assert!((scale / (2.0 * slope) - 1.0).abs() < 1e-3, "{slope}: {scale}");
    }
}

#[test]
fn bumps_of_common_height_keep_their_scale() {
    for slope in [0.0, 0.26, 1.0, 8.0] {
        assert_eq!(scale_of(slope, 0), 1.0, "{slope}");
    }
}

#[test]
fn maps_with_flat_areas_get_a_scale_that_keeps_their_bytes() {
    for (slope, flat, odd) in [(0.02, 8, 35.0), (0.15, 2, 3.0), (0.3, 8, 3.0)] {
        assert_eq!(scale_of(slope, flat), 1.0 / odd, "{slope}, {flat} of 16 flat");
    }
    assert_eq!(scale_of(0.001, 0), 1.0 / 499.0, "a byte holds no slope of the map");
}

#[test]
fn the_nearest_scale_that_keeps_bytes_is_taken() {
    for (scale, expected) in [(1.7, 1.0), (0.6, 1.0), (0.55, 1.0 / 3.0), (0.26, 1.0 / 3.0), (0.25, 0.2)] {
        assert_eq!(byte_scale(scale), expected, "{scale}");
    }
    assert_eq!(byte_scale(1.8), 1.8, "steep bumps lose more to a scale of 1 than to other bytes");
    assert!((byte_scale(1e-4) / 1e-4 - 1.0).abs() < 1e-3);
}

/// Bytes of nearly flat normals, as 8 bits store them, are bytes again under each scale of [`byte_scale`].
#[test]
fn flat_areas_keep_their_normals() {
    for scale in [0.01, 0.1, 0.3, 0.5, 0.9].map(byte_scale) {
        for byte in [127.0_f32, 128.0] {
            let slope = (byte - 127.5) / 127.5 / scale;
            let x = slope / (1.0 + slope * slope).sqrt();
            let stored = ((0.5 * x + 0.5) * 255.0).round() / 127.5 - 1.0;
            let shown = scale * stored / (1.0 - stored * stored).sqrt();
            let expected = scale * slope;
            assert!((shown - expected).abs() < 0.02 * expected.abs(), "{byte} under {scale}: {shown}, not {expected}");
        }
    }
}
