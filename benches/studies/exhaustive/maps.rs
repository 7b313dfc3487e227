//! The maps of the study: crops of real maps, and generated maps.

use std::error::Error;
use std::path::Path;

use roughcast::decode::decode;
use roughcast::image::{DecodeOptions, Image, Samples};

const REAL: [&str; 5] =
    ["aluminium_normal.png", "wool_normal.png", "sand_normal.jpg", "texture_bricks_normal.jpg", "water_normals.png"];
/// Texels along a side of a map.
const SIDE: u32 = 256;

/// Returns the maps by name.
pub fn maps() -> Result<Vec<(String, Image)>, Box<dyn Error>> {
    let mut maps = Vec::new();
    for name in REAL {
        if let Ok(bytes) = std::fs::read(Path::new("../shared/data/maps").join(name)) {
            let stem = name.split('.').next().unwrap_or(name);
            maps.push((stem.to_owned(), centre(&decode(&bytes, &DecodeOptions::default())?)));
        }
    }
    let noise = |x: u32, y: u32, seed: u32| {
        let mixed = x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77) ^ seed.wrapping_mul(0xc2b2_ae3d);
        let mixed = (mixed ^ mixed >> 15).wrapping_mul(0x2c1b_3c6d);
        let mixed = (mixed ^ mixed >> 12).wrapping_mul(0x297a_2d39);
        f64::from(mixed ^ mixed >> 15) / f64::from(u32::MAX) - 0.5
    };
    let waves = |x: u32, y: u32| {
        let (x, y) = (f64::from(x), f64::from(y));
        [0.25 * (0.1 * x + (0.07 * y).sin()).sin() + 0.1 * (0.9 * y).cos(), 0.3 * (0.13 * y + 0.2 * x).cos()]
    };
    let brushed = |x: u32, y: u32| [0.05 * noise(x / 8, y, 1), 0.8 * noise(x / 64, y, 2)];
    let polished = |x: u32, y: u32| {
        let scratch = if (x + y / 5).is_multiple_of(43) { 0.05 } else { 0.0 };
        [scratch + 0.01 * noise(x / 4, y / 4, 1), 0.01 * noise(x / 4, y / 4, 2)]
    };
    maps.push(("waves".to_owned(), generated(waves)));
    maps.push(("brushed metal".to_owned(), generated(brushed)));
    maps.push(("low relief".to_owned(), generated(polished)));
    Ok(maps)
}

/// Returns the square of [`SIDE`] texels in the middle of `image`.
fn centre(image: &Image) -> Image {
    let (left, top) = ((image.width - SIDE) / 2, (image.height - SIDE) / 2);
    let level = |x: u32, y: u32, c| (image.sample(left + x, top + y, c).unwrap_or(0.0) * 65535.0).round() as u16;
    map(|x, y| [0, 1, 2].map(|c| level(x, y, c)))
}

/// Returns the map of these slopes.
fn generated(slope: impl Fn(u32, u32) -> [f64; 2]) -> Image {
    map(|x, y| {
        let [u, v] = slope(x, y);
        let length = (u * u + v * v + 1.0).sqrt();
        [-u / length, -v / length, 1.0 / length].map(|c| ((0.5 * c + 0.5) * 65535.0).round() as u16)
    })
}

fn map(texel: impl Fn(u32, u32) -> [u16; 3]) -> Image {
    let samples = (0..SIDE * SIDE).flat_map(|i| texel(i % SIDE, i / SIDE)).collect();
    Image { width: SIDE, height: SIDE, channels: 3, samples: Samples::U16(samples) }
}
