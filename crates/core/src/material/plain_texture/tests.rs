use super::*;
use crate::image::Samples;

const WRAP: [Wrap; 2] = [Wrap::Repeat; 2];

/// Returns an image of bytes that repeat after a while.
fn image(width: u32, height: u32, channels: u32) -> Image {
    let count = width * height * channels;
    let samples = (0..count).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    Image { width, height, channels, samples: Samples::U8(samples) }
}

fn texel(image: &Image, x: u32, y: u32) -> [f64; 4] {
    let mut row = vec![[0.0; 4]; image.width as usize];
    Rgba(image).row(y, &mut row);
    row[x as usize].map(f64::from)
}

fn rows(texture: &PlainTexture<'_>, level: usize) -> Vec<[f32; 4]> {
    let (width, height) = texture.sizes()[level];
    let mut texels = vec![[0.0; 4]; (width * height) as usize];
    texels.chunks_mut(width as usize).zip(0..).for_each(|(row, y)| texture.row(level, y, row));
    texels
}

/// Returns the sRGB value of a linear one, in double precision.
fn srgb(value: f64) -> f64 {
    if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 }
}

/// Returns the share of texel `i` of `fine` texels that lies in texel `at` of `coarse` ones, of the latter's length.
fn share(i: u32, fine: u32, at: u32, coarse: u32) -> f64 {
    let edge = |n: u32, count: u32| f64::from(n) / f64::from(count);
    let (from, to) = (edge(i, fine).max(edge(at, coarse)), edge(i + 1, fine).min(edge(at + 1, coarse)));
    (to - from).max(0.0) * f64::from(coarse)
}

/// Returns a texel of level 1 by its definition: the means of linear light, weighted by area and alpha.
fn oracle(image: &Image, x: u32, y: u32, has_alpha: bool) -> [f64; 4] {
    let (width, height) = (image.width, image.height);
    let (mut light, mut weight, mut alpha) = ([0.0; 3], 0.0, 0.0);
    for (i, j) in (0..width).flat_map(|i| (0..height).map(move |j| (i, j))) {
        let area = share(i, width, x, (width / 2).max(1)) * share(j, height, y, (height / 2).max(1));
        let [red, green, blue, a] = texel(image, i, j);
        let count = if has_alpha { area * a } else { area };
        (weight, alpha) = (weight + count, alpha + area * a);
        for (sum, value) in light.iter_mut().zip([red, green, blue]) {
            *sum += count * srgb_to_linear(value);
        }
    }
    let [red, green, blue] = light.map(|light| srgb(light / weight));
    [red, green, blue, if has_alpha { alpha } else { 1.0 }]
}

#[test]
fn colours_are_means_of_linear_light_at_any_size() {
    for (width, height) in [(4, 4), (8, 4), (7, 5), (12, 1), (1, 9)] {
        for (channels, alpha) in [(3, AlphaUse::Opaque), (4, AlphaUse::Opaque), (4, AlphaUse::Blend)] {
            let image = image(width, height, channels);
            let texture = PlainTexture::new(&image, Meaning::Colour(alpha), (width, height), WRAP);
            assert_eq!(texture.has_alpha(), alpha == AlphaUse::Blend);
            let found = rows(&texture, 1);
            let columns = (width / 2).max(1);
            for (at, found) in (0..).zip(found) {
                let expected = oracle(&image, at % columns, at / columns, texture.has_alpha());
                for (found, expected) in found.into_iter().zip(expected) {
                    assert!((f64::from(found) - expected).abs() < 2e-6, "{width} x {height}: {found} for {expected}");
                }
            }
        }
    }
}

#[test]
fn level_0_is_the_image_and_linear_values_are_plain_means() {
    let image = image(8, 8, 4);
    for meaning in [Meaning::Linear, Meaning::Colour(AlphaUse::Opaque), Meaning::Colour(AlphaUse::Blend)] {
        let texture = PlainTexture::new(&image, meaning, (8, 8), WRAP);
        for (at, found) in (0..).zip(rows(&texture, 0)) {
            assert_eq!(found.map(f64::from), texel(&image, at % 8, at / 8));
        }
    }
    let texture = PlainTexture::new(&image, Meaning::Linear, (8, 8), WRAP);
    let mean = |c: usize| (0..4).map(|i| texel(&image, i % 2, i / 2)[c]).sum::<f64>() / 4.0;
    assert!((0..3).all(|c| (f64::from(rows(&texture, 1)[0][c]) - mean(c)).abs() < 1e-6));
}

#[test]
fn other_grids_are_interpolated_in_linear_light() {
    let image = Image { width: 2, height: 1, channels: 3, samples: Samples::U8(vec![0, 0, 0, 255, 255, 255]) };
    let texture = PlainTexture::new(&image, Meaning::Colour(AlphaUse::Opaque), (4, 4), [Wrap::Clamp; 2]);
    let row: Vec<f64> = rows(&texture, 0)[..4].iter().map(|texel| f64::from(texel[0])).collect();
    for (found, expected) in row.into_iter().zip([0.0, 0.25, 0.75, 1.0]) {
        assert!((found - srgb(expected)).abs() < 1e-6, "{found} for {expected}");
    }
}

#[test]
fn hidden_colours_do_not_bleed_and_clear_texels_keep_a_colour() {
    // One red texel that is seen, and green ones that are not.
    let mut samples = [0, 255, 0, 0].repeat(16);
    samples[..4].copy_from_slice(&[255, 0, 0, 255]);
    let image = Image { width: 4, height: 4, channels: 4, samples: Samples::U8(samples) };
    let texture = PlainTexture::new(&image, Meaning::Colour(AlphaUse::Blend), (4, 4), WRAP);
    let expected = [[1.0, 0.0, 0.0, 0.25], [0.0, 1.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]];
    let off = rows(&texture, 1).into_iter().zip(expected).flat_map(|(a, b)| (0..4).map(move |c| (a[c] - b[c]).abs()));
    assert!(off.fold(0.0, f32::max) < 1e-6, "{:?}", rows(&texture, 1));
}

#[test]
fn masks_keep_their_coverage_at_every_level() {
    let image = image(64, 64, 4);
    for cutoff in [0.1, 0.5, 0.8] {
        let texture = PlainTexture::new(&image, Meaning::Colour(AlphaUse::Mask(cutoff)), (64, 64), WRAP);
        let share = |level: usize| {
            let alphas: Vec<f32> = rows(&texture, level).iter().map(|texel| texel[3]).collect();
            coverage(&alphas, cutoff)
        };
        for level in 1..texture.sizes().len() {
            let (width, height) = texture.sizes()[level];
            let step = 1.0 / f64::from(width * height);
            assert!((share(level) - share(0)).abs() <= 0.5 * step + 0.01, "{cutoff}, level {level}: {}", share(level));
        }
        // Without the factor, the noise of this image has no mask left.
        let plain = PlainTexture::new(&image, Meaning::Colour(AlphaUse::Blend), (64, 64), WRAP);
        let passing = rows(&plain, 4).iter().filter(|texel| texel[3] >= cutoff).count();
        assert!(cutoff == 0.5 || passing == 0 || passing == 16);
    }
}
