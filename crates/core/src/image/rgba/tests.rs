use super::*;

#[test]
fn colours_beyond_half_floats_are_clamped() {
    let image = |samples: Vec<f32>| Image { width: 2, height: 1, channels: 2, samples: Samples::F32(samples) };
    let clamped = image(vec![f32::MAX, -1e30, 0.25, 7.0]).into_finite_colours();
    assert_eq!(clamped, Ok(image(vec![65504.0, -65504.0, 0.25, 7.0])));
    assert!(image(vec![0.0, f32::NAN, 0.0, 0.0]).into_finite_colours().is_err());
}

#[test]
fn green_equals_that_of_rgba_texels() {
    for channels in 1..=4 {
        let bytes: Vec<u8> = (0..12 * channels).map(|i| (i * 19 % 251) as u8).collect();
        let all: [Samples; 3] = [
            Samples::U16(bytes.iter().map(|&v| 257 * u16::from(v) / 2).collect()),
            Samples::F32(bytes.iter().map(|&v| f32::from(v) - 3.5).collect()),
            Samples::U8(bytes),
        ];
        for samples in all {
            let image = Image { width: 4, height: 3, channels, samples };
            for y in 0..3 {
                let (mut texels, mut green) = ([[0.0; 4]; 4], [0.0; 4]);
                Rgba(&image).row(y, &mut texels);
                Rgba(&image).green(y, &mut green);
                assert_eq!(green, texels.map(|texel| texel[1]), "{channels} channels");
            }
        }
    }
}

#[test]
fn finds_constant_red_and_blue() {
    for channels in 1..=4 {
        let mut bytes = [51, 0, 102, 7][..channels].repeat(12);
        let red_blue = |bytes: &[u8]| {
            let image = Image { width: 4, height: 3, channels: channels as u32, samples: Samples::U8(bytes.to_vec()) };
            Rgba(&image).common_red_blue()
        };
        assert_eq!(red_blue(&bytes), Some([0.2, [0.2, 0.0, 0.4, 0.4][channels - 1]]), "{channels} channels");
        for c in 0..channels {
            let last = bytes.len() - channels + c;
            bytes[last] += 1;
            assert_eq!(red_blue(&bytes).is_none(), c % 2 == 0, "channel {c} of {channels}");
            bytes[last] -= 1;
        }
    }
}

#[test]
fn grey_with_alpha_is_grey_in_every_colour() {
    let image = Image { width: 1, height: 1, channels: 2, samples: Samples::U8(vec![51, 7]) };
    let mut texel = [[0.0; 4]];
    Rgba(&image.clone()).row(0, &mut texel);
    assert_eq!(texel, [[0.2, 7.0 / 255.0, 0.0, 1.0]]);
    Rgba(&image.with_grey_as_colour()).row(0, &mut texel);
    assert_eq!(texel, [[0.2, 0.2, 0.2, 7.0 / 255.0]]);
}

#[test]
fn the_ranges_of_colours_are_those_of_rgba_texels() {
    for channels in 1..=4 {
        let bytes: Vec<u8> = (0..9000 * channels).map(|i| (20 + i * 19 % 201) as u8).collect();
        let all: [Samples; 3] = [
            Samples::U16(bytes.iter().map(|&v| 257 * u16::from(v) / 2).collect()),
            Samples::F32(bytes.iter().map(|&v| f32::from(v) - 3.5).collect()),
            Samples::U8(bytes),
        ];
        for samples in all {
            let image = Image { width: 9000, height: 1, channels, samples };
            let mut texels = vec![[0.0; 4]; 9000];
            Rgba(&image).row(0, &mut texels);
            let ranges = [0, 1, 2].map(|channel| {
                let colours = || texels.iter().map(|texel| texel[channel]);
                [colours().fold(f32::MAX, f32::min), colours().fold(f32::MIN, f32::max)]
            });
            assert_eq!(image.colour_ranges(), ranges, "{channels} channels");
        }
    }
}
