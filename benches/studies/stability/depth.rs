//! Effects of the bit depth and the compression of a source: false bumps, and small bumps that are lost.

use std::error::Error;

use half::f16;
use jpeg_encoder::{ColorType, Encoder, SamplingFactor};
use roughcast::bump::{HeightMap, HeightOffsets, Moments, NormalMap, NormalOffsets};
use roughcast::decode::decode;
use roughcast::image::{DecodeOptions, Image, Samples};
use roughcast::mip::{Level, Pyramid, TexelRows, Wrap};

use super::synthetic::{level, map, normals};
use super::{head, row};

const SIZE: u32 = 256;

/// Reads level 0 of a map.
fn read<R: TexelRows<Texel = Moments>>(rows: &R) -> Level<Moments> {
    let (width, height) = (rows.width(), rows.height());
    let mut texels = vec![Moments::default(); width as usize * height as usize];
    texels.chunks_exact_mut(width as usize).enumerate().for_each(|(y, out)| rows.row(y as u32, out));
    Level { width, height, texels }
}

/// Returns the variance along u, about the exact slopes.
fn noise(found: &Level<Moments>, exact: &Level<Moments>) -> f64 {
    let squares = found.texels.iter().zip(&exact.texels).map(|(a, b)| f64::from(a.mean.u - b.mean.u).powi(2));
    squares.sum::<f64>() / found.texels.len() as f64
}

/// Returns the roughness that a mirror gets from a variance: alpha^2 = 2 sigma^2.
fn roughness(variance: f64) -> String {
    format!("{:.3}", (2.0 * variance).sqrt().sqrt())
}

/// Prints a smooth dome of slopes up to 0.3, and the same dome under bumps of a few texels.
pub fn print_normals() -> Result<(), Box<dyn Error>> {
    head(
        "Noise floors of normal maps: false bumps of a smooth map",
        &["source", "variance by `noise`", "variance found", "roughness of a mirror"],
    );
    let dome = |x: u32, y: u32| [x, y].map(|c| 0.6 * (f64::from(c) / f64::from(SIZE) - 0.5));
    let bumpy = |x: u32, y: u32| {
        let wave = |c: u32| 0.2 * libm::sin(0.9 * f64::from(c));
        [wave(x) * libm::cos(0.31 * f64::from(y)), wave(y)]
    };
    let bytes = |exact: &Level<Moments>| -> Vec<u8> {
        normals(exact).iter().map(|c| ((0.5 * c + 0.5) * 255.0).round() as u8).collect()
    };
    let smooth = level(SIZE, SIZE, dome);
    let components = normals(&smooth);
    let words = components.iter().map(|c| ((0.5 * c + 0.5) * 65535.0).round() as u16).collect();
    let halves = components.iter().map(|c| f16::from_f64(*c).to_f32()).collect();
    let maps: [(&str, NormalMap); 3] = [
        ("dome, 8 bits", map(SIZE, Samples::U8(bytes(&smooth)))?),
        ("dome, 16 bits", map(SIZE, Samples::U16(words))?),
        ("dome, half floats", map(SIZE, Samples::F32(halves))?),
    ];
    for (name, map) in &maps {
        print_noise(name, map, &smooth);
    }
    for (surface, exact) in [("dome", &smooth), ("bumps", &level(SIZE, SIZE, bumpy))] {
        for (sampling, chroma) in [(SamplingFactor::F_1_1, "4:4:4"), (SamplingFactor::F_2_2, "4:2:0")] {
            for quality in [95, 85, 75] {
                let mut file = Vec::new();
                let mut encoder = Encoder::new(&mut file, quality);
                encoder.set_sampling_factor(sampling);
                encoder.encode(&bytes(exact), SIZE as u16, SIZE as u16, ColorType::Rgb)?;
                let Samples::U8(samples) = decode(&file, &DecodeOptions::default())?.samples else { continue };
                let map = map(SIZE, Samples::U8(samples))?;
                print_noise(&format!("{surface}, JPEG {quality}, {chroma}"), &map, exact);
            }
        }
    }
    Ok(())
}

fn print_noise(name: &str, map: &NormalMap, exact: &Level<Moments>) {
    let offsets = NormalOffsets::new(map);
    let found = noise(&read(&offsets), exact);
    row(&[name.to_owned(), format!("{:.1e}", offsets.noise().uu), format!("{found:.1e}"), roughness(found)]);
}

/// Prints waves of 17 texels of falling height, on a map whose height of 1 is 0.05 widths of 1024 texels.
pub fn print_heights() -> Result<(), Box<dyn Error>> {
    let slope_per_step = [0.05 * 1024.0, 0.0];
    head(
        "Height maps with tiny bumps: deviation of slopes found, over that of the exact ones; and the floor",
        &["bumps", "8 bits", "16 bits", "half floats", "floats", "floats 100 higher"],
    );
    let mut floors = [const { String::new() }; 5];
    for bump_map in [0.1, 0.01, 0.001, 0.0001, 0.00001] {
        let wave = |x: u32| 0.4 + 0.5 * bump_map * libm::sin(0.37 * f64::from(x));
        let mut cells = vec![bump_map.to_string()];
        let exact: f64 = deviation(&slopes(Samples::F32(heights(&|x| (wave(x) - 0.4) as f32)), slope_per_step)?.0);
        let sources = [
            Samples::U8(heights(&|x| (wave(x) * 255.0).round() as u8)),
            Samples::U16(heights(&|x| (wave(x) * 65535.0).round() as u16)),
            Samples::F32(heights(&|x| f16::from_f64(wave(x)).to_f32())),
            Samples::F32(heights(&|x| wave(x) as f32)),
            Samples::F32(heights(&|x| (wave(x) + 100.0) as f32)),
        ];
        for (samples, floor) in sources.into_iter().zip(&mut floors) {
            let (found, noise) = slopes(samples, slope_per_step)?;
            cells.push(format!("{:.3}", deviation(&found) / exact));
            *floor = roughness(noise);
        }
        row(&cells);
    }
    row(&[vec!["roughness of a mirror by rounding alone".to_owned()], floors.to_vec()].concat());
    Ok(())
}

fn heights<T>(at: &dyn Fn(u32) -> T) -> Vec<T> {
    (0..SIZE * 2).map(|i| at(i % SIZE)).collect()
}

/// Returns slopes inside a map of two rows, and the variance that rounding alone gives the slopes.
fn slopes(samples: Samples, slope_per_step: [f32; 2]) -> Result<(Vec<f64>, f64), Box<dyn Error>> {
    let map = HeightMap::new(Image { width: SIZE, height: 2, channels: 1, samples })?;
    let offsets = HeightOffsets::new(&map, slope_per_step, [Wrap::Clamp; 2]);
    let inner = 1..SIZE as usize - 1;
    let slopes = read(&offsets).texels[inner].iter().map(|m| f64::from(m.mean.u)).collect();
    Ok((slopes, f64::from(offsets.noise().uu)))
}

fn deviation(slopes: &[f64]) -> f64 {
    let flat = |s: &f64| Moments::flat(roughcast::bump::Offset { u: *s as f32, v: 0.0 });
    let texels: Vec<Moments> = slopes.iter().map(flat).collect();
    let whole = Pyramid::new(Level { width: texels.len() as u32, height: 1, texels }).coarsest();
    f64::from(whole.covariance.uu).sqrt()
}

/// Prints the messages about NaN and infinity.
pub fn print_not_finite() {
    println!("\n### NaN and infinity\n");
    for bad in [f32::NAN, f32::INFINITY] {
        let mut heights = vec![0.5; 64];
        heights[11] = bad;
        let image = Image { width: 8, height: 8, channels: 1, samples: Samples::F32(heights) };
        if let Err(error) = HeightMap::new(image) {
            println!("{bad}: {error}");
        }
    }
}
