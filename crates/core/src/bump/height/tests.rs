use super::*;
use crate::image::{Image, Samples};

fn slopes(heights: &[f32], width: u32, wrap: Wrap) -> Vec<Offset> {
    let height = heights.len() as u32 / width;
    let image = Image { width, height, channels: 1, samples: Samples::F32(heights.to_vec()) };
    let map = HeightMap::new(image).unwrap();
    let rows = HeightOffsets::new(&map, [1.0; 2], [wrap; 2]);
    let mut all = vec![Moments::default(); heights.len()];
    for (y, row) in all.chunks_exact_mut(width as usize).enumerate() {
        rows.row(y as u32, row);
    }
    all.iter().map(|m| m.mean).collect()
}

#[test]
fn a_ramp_has_its_slope_at_the_border_too_when_clamped() {
    for offset in slopes(&[0.0, 0.5, 1.0, 1.5], 4, Wrap::Clamp) {
        assert_eq!(offset, Offset { u: 0.5, v: 0.0 });
    }
}

#[test]
fn one_period_of_a_wave_has_no_seam_when_repeated() {
    let wave: Vec<f32> = (0..64).map(|i| (f64::from(i) / 64.0 * std::f64::consts::TAU).sin() as f32).collect();
    let offsets = slopes(&wave, 64, Wrap::Repeat);
    let step = std::f64::consts::TAU / 64.0;
    for (i, offset) in offsets.iter().enumerate() {
        // The central difference of a sine: cos(x) sin(step).
        let expected = (i as f64 * step).cos() * step.sin();
        assert!((f64::from(offset.u) - expected).abs() < 1e-6, "{i}");
    }
}

#[test]
fn a_mirrored_ramp_halves_its_slope_at_the_mirror() {
    let offsets = slopes(&[0.0, 1.0, 2.0, 3.0], 4, Wrap::Mirror);
    assert_eq!(offsets.iter().map(|o| o.u).collect::<Vec<_>>(), [0.5, 1.0, 1.0, 0.5]);
}

#[test]
fn heights_rising_towards_row_0_have_a_positive_slope_along_b() {
    let offsets = slopes(&[2.0, 1.0, 0.0], 1, Wrap::Clamp);
    for offset in offsets {
        assert_eq!(offset, Offset { u: 0.0, v: 1.0 });
    }
}

/// Measures the error of the slopes of waves with a depth of 1/4096: in 8 and 16 bits, and in floats on top of a
/// mountain. Eight bits hold nothing of the waves.
#[test]
fn tiny_depths_survive_in_sixteen_bits_with_the_predicted_noise() {
    let n = 128u32;
    let wave = |x: u32, base: f64| base + f64::sin(0.37 * f64::from(x)) / 8192.0;
    let exact = |x: u32| 0.5 * (wave(x + 1, 0.0) - wave(x.wrapping_sub(1), 0.0));
    let error = |base: f64, round: &dyn Fn(f64) -> f32, samples: &dyn Fn(Vec<f32>) -> Samples| {
        let heights = (0..n * 2).map(|i| round(wave(i % n, base))).collect();
        let map = HeightMap::new(Image { width: n, height: 2, channels: 1, samples: samples(heights) }).unwrap();
        let offsets = HeightOffsets::new(&map, [1.0; 2], [Wrap::Repeat; 2]);
        let mut row = vec![Moments::default(); n as usize];
        offsets.row(0, &mut row);
        let inner = 1..n - 1;
        let squares = inner.clone().map(|x| (f64::from(row[x as usize].mean.u) - exact(x)).powi(2));
        let signal = inner.map(|x| exact(x).powi(2)).sum::<f64>();
        (squares.sum::<f64>() / signal, f64::from(offsets.noise().uu) * f64::from(n - 2) / signal)
    };
    let integers = |one: f64| move |h: f64| (h * one).round() as f32;
    let bytes = |v: Vec<f32>| Samples::U8(v.iter().map(|h| *h as u8).collect());
    let words = |v: Vec<f32>| Samples::U16(v.iter().map(|h| *h as u16).collect());
    let (lost, _) = error(0.4, &integers(255.0), &bytes);
    assert_eq!(lost, 1.0, "one byte throughout: no wave at all");
    let (lost, predicted) = error(0.4, &integers(65535.0), &words);
    assert!(lost < 0.02 && (0.5..2.0).contains(&(lost / predicted)), "{lost} {predicted}");
    // Floats are as good as their magnitude allows: nothing lost at 0, and little at 100.
    assert!(error(0.0, &|h| h as f32, &Samples::F32).0 < 1e-12);
    let (lost, predicted) = error(100.0, &|h| h as f32, &Samples::F32);
    assert!(lost < predicted && lost > 0.05 * predicted, "{lost} {predicted}");
}

#[test]
fn single_texels_are_flat() {
    for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
        assert_eq!(slopes(&[0.7], 1, wrap), [Offset::default()]);
    }
}
