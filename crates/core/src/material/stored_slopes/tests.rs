use super::*;
use crate::bump::{NormalLayout, NormalMap};
use crate::image::{Image, Samples};
use crate::material::bump_map::BumpMap;

/// Returns the scale of a map of 16 x 600 texels, in whose rows the slopes are `slope` and -`slope` by turns.
fn scale_of(slope: f32) -> f32 {
    let texel = |i: u32| {
        let u = if i.is_multiple_of(2) { slope } else { -slope };
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
    for slope in [0.001, 0.02, 0.2] {
        let scale = scale_of(slope);
        assert!((scale / (2.0 * slope) - 1.0).abs() < 1e-3, "{slope}: {scale}");
    }
}

#[test]
fn bumps_of_common_height_keep_their_scale() {
    for slope in [0.0, 0.26, 1.0, 8.0] {
        assert_eq!(scale_of(slope), 1.0, "{slope}");
    }
}
