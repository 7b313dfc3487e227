use super::*;

fn image(channels: u32, samples: Samples) -> Image {
    Image { width: 1, height: 1, channels, samples }
}

fn only_normal(image: Image, layout: NormalLayout, green_down: bool) -> [f32; 3] {
    let map = NormalMap::new(image, layout, green_down).unwrap();
    let mut out = [[0.0; 3]];
    map.row(0, &mut out);
    out[0]
}

fn close(a: [f32; 3], b: [f32; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4)
}

#[test]
fn integers_decode_as_engines_do() {
    let normal = only_normal(image(3, Samples::U8(vec![255, 0, 128])), NormalLayout::Auto, false);
    assert!(close(normal, [1.0, -1.0, 1.0 / 255.0]));
    let normal = only_normal(image(4, Samples::U16(vec![65535, 0, 65535, 0])), NormalLayout::Auto, true);
    assert!(close(normal, [1.0, 1.0, 1.0]));
}

#[test]
fn two_channels_rebuild_z() {
    for (channels, samples) in [(2, vec![0.6, 0.0]), (3, vec![0.6, -1e-9, 0.0])] {
        let mut samples = samples;
        samples[1] = -0.0;
        samples[0] = -0.6;
        let normal = only_normal(image(channels, Samples::F32(samples)), NormalLayout::Auto, false);
        assert!(close(normal, [-0.6, 0.0, 0.8]), "{normal:?}");
    }
}

#[test]
fn floats_without_a_negative_are_biased() {
    let normal = only_normal(image(3, Samples::F32(vec![0.5, 0.8, 0.9])), NormalLayout::Auto, false);
    assert!(close(normal, [0.0, 0.6, 0.8]));
}

/// One such texel would spoil every level.
#[test]
fn vectors_of_any_length_keep_their_direction() {
    for length in [f32::MAX, 1e20, 1e-20, 1e-37] {
        let texel = [-0.6 * length, 0.0, 0.8 * length];
        let normal = only_normal(image(3, Samples::F32(texel.to_vec())), NormalLayout::Xyz, false);
        assert!(close(normal, [-0.75, 0.0, 1.0]), "{length}: {normal:?}");
    }
    let long = only_normal(image(3, Samples::F32(vec![f32::MAX, 0.5, 0.5])), NormalLayout::Xyz, false);
    assert!(close(long, [1.0, 0.0, 0.0]), "{long:?}");
    let two = only_normal(image(2, Samples::F32(vec![-f32::MAX, 1.0])), NormalLayout::Xy, false);
    assert!(close(two, [-1.0, 0.0, 0.0]), "{two:?}");
    let usual = vec![-0.1, 0.2, 0.9];
    assert_eq!(only_normal(image(3, Samples::F32(usual)), NormalLayout::Xyz, false), [-0.1, 0.2, 0.9]);
}

#[test]
fn unusable_images_are_refused() {
    let grey = image(1, Samples::U8(vec![0]));
    assert!(matches!(NormalMap::new(grey, NormalLayout::Auto, false), Err(MapError::Channels { found: 1, .. })));
    let bad = image(3, Samples::F32(vec![0.0, f32::NAN, 1.0]));
    assert!(matches!(
        NormalMap::new(bad, NormalLayout::Auto, false),
        Err(MapError::NotFinite { count: 1, x: 0, y: 0 })
    ));
}
