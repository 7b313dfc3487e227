use super::*;
use crate::image::srgb::srgb_to_linear;

/// Weighs the linear values of red, green and blue, and adds alpha.
fn function(channel: usize, value: f64) -> f64 {
    if channel == 3 { value } else { [0.2, 0.7, 0.1][channel] * srgb_to_linear(value) }
}

/// Returns the sum of a texel in double precision.
fn oracle(texel: [f32; 4]) -> f64 {
    (0..4).map(|channel| function(channel, texel[channel].into())).sum()
}

/// Compares the sums of all texels with the oracle.
fn check(image: &Image, bound: f64) {
    let sums = ChannelSum::new(image, function);
    let (mut row, mut texels) = (vec![[0.0]; image.width as usize], vec![[0.0; 4]; image.width as usize]);
    for y in 0..image.height {
        sums.row(y, &mut row);
        Rgba(image).row(y, &mut texels);
        for ([sum], texel) in row.iter().zip(&texels) {
            assert!((f64::from(*sum) - oracle(*texel)).abs() < bound, "{texel:?}: {sum}");
        }
    }
}

#[test]
fn sums_of_bytes_are_those_of_the_rgba_texels() {
    for channels in 1..=4 {
        let samples = Samples::U8((0..=255).cycle().take((16 * 16 * channels) as usize).collect());
        check(&Image { width: 16, height: 16, channels, samples }, 1e-6);
    }
}

#[test]
fn interpolation_changes_colours_of_16_bits_little() {
    let samples = Samples::U16((0..=u16::MAX).collect());
    check(&Image { width: 256, height: 256, channels: 1, samples }, 7e-6);
}

#[test]
fn floats_beyond_the_range_are_clamped() {
    let samples = Samples::F32(vec![-65504.0, 0.5, 2.0, 65504.0]);
    let image = Image { width: 1, height: 1, channels: 4, samples };
    let mut row = [[0.0]];
    ChannelSum::new(&image, function).row(0, &mut row);
    assert!((f64::from(row[0][0]) - oracle([0.0, 0.5, 1.0, 1.0])).abs() < 1e-5);
}

#[test]
fn only_images_of_equal_texels_are_constant() {
    let image = |last| {
        let mut samples = [51, 102].repeat(5000);
        samples[9999] = last;
        Image { width: 500, height: 10, channels: 2, samples: Samples::U8(samples) }
    };
    let expected = oracle([0.2, 0.4, 0.0, 1.0]) as f32;
    assert!((ChannelSum::new(&image(102), function).constant().unwrap() - expected).abs() < 1e-6);
    assert_eq!(ChannelSum::new(&image(103), function).constant(), None);
}
