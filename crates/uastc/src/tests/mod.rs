//! Tests of the encoder and the decoder against independent decoders: `basisu` for UASTC and for transcoding, and
//! `texture2ddecoder` for the transcoded blocks.

mod alpha;
mod decode;
mod direction;
mod hints;
mod level;
mod lobe;
mod quality;
mod rate;

use crate::lanes::Texels;
use crate::{BLOCK_BYTES, Effort, Encoder, Image, Metric, Weight};
use basisu::uastc::unpack::unpack_uastc;

/// A random generator (SplitMix64) that gives the same test cases on every machine.
pub(super) struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn byte(&mut self) -> u8 {
        self.next() as u8
    }

    /// Returns a number that is uniform in 0..1.
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Encodes one block.
pub(super) fn encode_block(texels: &Texels, metric: Metric, effort: Effort) -> [u8; BLOCK_BYTES] {
    encode(texels.as_flattened(), (4, 4), metric, effort)[0]
}

/// Encodes an image.
pub(super) fn encode(
    texels: &[u8],
    (width, height): (usize, usize),
    metric: Metric,
    effort: Effort,
) -> Vec<[u8; BLOCK_BYTES]> {
    Encoder::new(metric, effort).encode(&image(texels, (width, height)))
}

pub(super) fn image(texels: &[u8], (width, height): (usize, usize)) -> Image<'_> {
    Image::new(texels, width as u32, height as u32).expect("texels of that size")
}

/// Decodes a block with `basisu`.
pub(super) fn decoded(block: &[u8; BLOCK_BYTES]) -> Texels {
    unpack_uastc(block, false).expect("a block of a known mode").map(|texel| texel.c)
}

/// Returns the sum of squared differences of red, green and blue.
pub(super) fn squared_error(a: &Texels, b: &Texels) -> u32 {
    a.iter().zip(b).flat_map(|(a, b)| (0..3).map(move |c| u32::from(a[c].abs_diff(b[c])).pow(2))).sum()
}

/// Returns the peak signal-to-noise ratio in dB, over RGB.
pub(super) fn psnr(a: &[Texels], b: &[Texels]) -> f64 {
    let error: f64 = a.iter().zip(b).map(|(a, b)| f64::from(squared_error(a, b))).sum();
    10.0 * (65025.0 * 48.0 * a.len() as f64 / error).log10()
}

/// Encodes a unit normal as an opaque texel.
pub(super) fn normal(x: f64, y: f64) -> [u8; 4] {
    let z = (1.0 - x * x - y * y).max(0.0).sqrt();
    let length = (x * x + y * y + z * z).sqrt();
    let level = |v: f64| ((v / length * 0.5 + 0.5) * 255.0).round() as u8;
    [level(x), level(y), level(z), 255]
}

/// Returns blocks of unit normals of a smooth surface with noise of the given slope.
pub(super) fn normals(noise: f64, count: usize) -> Vec<Texels> {
    let mut random = Random(7);
    (0..count)
        .map(|block| {
            let (at_x, at_y) = ((block % 16 * 4) as f64, (block / 16 * 4) as f64);
            std::array::from_fn(|i| {
                let (x, y) = (at_x + (i % 4) as f64, at_y + (i / 4) as f64);
                let mut wobble = || (random.unit() - 0.5) * noise;
                let sx = 0.3 * (x * 0.21 + 0.4 * (y * 0.17).sin()).sin() + wobble();
                let sy = 0.3 * (y * 0.13 + 0.7 * (x * 0.11).cos()).cos() + wobble();
                normal(sx, sy)
            })
        })
        .collect()
}

/// Returns blocks of every kind that the encoder treats differently.
pub(super) fn all_kinds() -> Vec<Texels> {
    let mut random = Random(1);
    let mut blocks = vec![
        // Extremes, checkers, edges.
        std::array::from_fn(|i| if i % 2 == 0 { [0; 4] } else { [255; 4] }),
        std::array::from_fn(|i| if i < 8 { [255, 0, 0, 255] } else { [0, 0, 255, 0] }),
        std::array::from_fn(|i| if i == 0 { [255, 255, 255, 0] } else { [0, 0, 0, 255] }),
        std::array::from_fn(|i| [[0, 255, 0, 128], [1, 254, 1, 127]][i / 3 % 2]),
    ];
    for channel in 0..4 {
        // A ramp and noise in one channel alone, both ways.
        for rising in [true, false] {
            blocks.push(std::array::from_fn(|i| {
                let mut texel = [128, 7, 255, 255];
                texel[channel] = if rising { i as u8 * 17 } else { 255 - i as u8 * 11 };
                texel
            }));
        }
        blocks.push(std::array::from_fn(|_| {
            let mut texel = [0, 255, 64, 255];
            texel[channel] = random.byte();
            texel
        }));
    }
    for spread in [1, 2, 3, 5, 9, 17, 40, 100, 255] {
        for _ in 0..30 {
            // Noise about a colour, and two noisy colours on either side of an edge.
            let base: [u8; 4] = std::array::from_fn(|_| random.byte());
            let other: [u8; 4] = std::array::from_fn(|_| random.byte());
            let edge = random.next() as u16;
            let mut noise = |colour: [u8; 4]| colour.map(|v| v.saturating_add((random.next() % spread) as u8));
            blocks.push(std::array::from_fn(|_| noise(base)));
            blocks.push(std::array::from_fn(|i| noise(if edge >> i & 1 == 1 { other } else { base })));
            // A gradient across the block, alpha included.
            blocks.push(std::array::from_fn(|i| {
                std::array::from_fn(|c| {
                    let (a, b) = (i32::from(base[c]), i32::from(other[c]));
                    (a + (b - a) * (i as i32 % 4 + i as i32 / 4) / 6) as u8
                })
            }));
        }
    }
    for spread in [4, 30, 255] {
        // Grey slopes with noise.
        blocks.extend((0..20).map(|k| {
            std::array::from_fn(|i| {
                let v = (k * 9 + i as u64 % 4 * (spread / 4) + random.next() % spread).min(255) as u8;
                [v, v, v, 255]
            })
        }));
    }
    blocks.extend(normals(0.0, 32));
    blocks.extend(normals(0.1, 32));
    blocks.extend(normals(0.9, 32));
    blocks.extend([3, 12, 60, 255].into_iter().flat_map(green));
    blocks
}

/// Returns blocks in which only green varies, by less than `spread`. Red and blue have random constant levels.
pub(super) fn green(spread: u64) -> impl Iterator<Item = Texels> {
    let mut random = Random(spread);
    (0..16).map(move |_| {
        let [red, base, blue, _]: [u8; 4] = std::array::from_fn(|_| random.byte());
        std::array::from_fn(|_| [red, base.saturating_add((random.next() % spread) as u8), blue, 255])
    })
}

pub(super) const EFFORTS: [Effort; 2] = [Effort::Fast, Effort::Best];
/// A metric in which green outweighs red and blue, as for roughness in ORM maps.
pub(super) const SURFACE: Metric = Metric::Weighted([Weight::Quarter, Weight::Full, Weight::Quarter]);
pub(super) const METRICS: [Metric; 4] = [Metric::Rgb, Metric::Rgba, SURFACE, Metric::Direction];
