//! Times encoding by metric and effort, rate-distortion optimisation, and decoding: `cargo bench --bench encoder`.
//!
//! Items are texels. `BENCH_SIZE` is the width and height of the images in texels, by default 2048.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use uastc_encoder::{Effort, Encoder, Image, Lobe, Metric, Weight, decode_block, lower_rate};

const ROUGHNESS: Metric = Metric::Weighted([Weight::Quarter, Weight::Full, Weight::Quarter]);
const EFFORTS: [Effort; 2] = [Effort::Fast, Effort::Best];

fn main() {
    divan::main();
}

/// Returns the width and height of the images in texels.
fn size() -> u32 {
    std::env::var("BENCH_SIZE").ok().and_then(|size| size.parse().ok()).unwrap_or(2048)
}

/// Makes an image whose texel at (x, y) is `texel` of x, y and noise in 0..1.
fn image(texel: impl Fn(f32, f32, f32) -> [u8; 4]) -> Vec<u8> {
    let mut state = 1u32;
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 16_777_216.0
    };
    let size = size();
    (0..size * size).flat_map(|i| texel((i % size) as f32, (i / size) as f32, noise())).collect()
}

/// Makes a normal map: waves of three lengths, and a grain that no compressor removes.
fn normals() -> Vec<u8> {
    image(|x, y, noise| {
        let [u, v] = [(x, y), (y, x)].map(|(a, b)| {
            0.25 * (a * 0.1 + (b * 0.07).sin()).sin() + 0.1 * (a * 0.9 + b * 0.3).cos() + 0.05 * (noise - 0.5)
        });
        let length = (u * u + v * v + 1.0).sqrt();
        let level = |v: f32| (127.5 + 127.5 * v / length).round() as u8;
        [level(-u), level(-v), level(1.0), 255]
    })
}

/// Makes a roughness map: smudges in green, with constant red and blue.
fn roughness() -> Vec<u8> {
    image(|x, y, noise| [255, (110.0 + 60.0 * (x * 0.05).sin() * (y * 0.04).cos() + 5.0 * noise) as u8, 0, 255])
}

fn encode(bencher: Bencher, texels: &[u8], metric: Metric, effort: Effort) {
    let (image, encoder) = (Image::new(texels, size(), size()).expect("a square"), Encoder::new(metric, effort));
    bencher.counter(ItemsCount::new(texels.len() / 4)).bench(|| encoder.encode(black_box(&image)));
}

#[divan::bench(args = EFFORTS, sample_count = 3)]
fn encode_normals(bencher: Bencher, effort: Effort) {
    encode(bencher, &normals(), Metric::Direction, effort);
}

/// Makes lobes that vary from texel to texel, with axis ratios up to 2.
fn lobes() -> Vec<Lobe> {
    let size = size() as usize;
    let lobe = |x: f32, y: f32| {
        let (a, b) = (0.1 + 0.05 * (x * 0.03).sin(), 0.1 + 0.05 * (y * 0.05).cos());
        Lobe { uu: a * a, uv: 0.2 * a * b, vv: b * b }
    };
    (0..size * size).map(|i| lobe((i % size) as f32, (i / size) as f32)).collect()
}

#[divan::bench(args = EFFORTS, sample_count = 3)]
fn encode_normals_with_lobes(bencher: Bencher, effort: Effort) {
    let (texels, lobes, encoder) = (normals(), lobes(), Encoder::new(Metric::Direction, effort));
    let image = Image::new(&texels, size(), size()).and_then(|image| image.with_lobes(&lobes)).expect("a square");
    bencher.counter(ItemsCount::new(texels.len() / 4)).bench(|| encoder.encode(black_box(&image)));
}

#[divan::bench(args = EFFORTS, sample_count = 3)]
fn encode_roughness(bencher: Bencher, effort: Effort) {
    encode(bencher, &roughness(), ROUGHNESS, effort);
}

#[divan::bench(sample_count = 3)]
fn lower_rate_of_normals(bencher: Bencher) {
    let texels = normals();
    let image = Image::new(&texels, size(), size()).expect("a square");
    let blocks = Encoder::new(Metric::Direction, Effort::Fast).encode(&image);
    bencher.counter(ItemsCount::new(texels.len() / 4)).with_inputs(|| blocks.clone()).bench_values(|mut blocks| {
        lower_rate(&mut blocks, &image, Metric::Direction, 0.5).expect("its blocks");
        blocks
    });
}

#[divan::bench(sample_count = 3)]
fn decode_normals(bencher: Bencher) {
    let texels = normals();
    let image = Image::new(&texels, size(), size()).expect("a square");
    let blocks = Encoder::new(Metric::Direction, Effort::Fast).encode(&image);
    bencher
        .counter(ItemsCount::new(texels.len() / 4))
        .bench(|| black_box(&blocks).iter().filter_map(decode_block).map(|texels| texels[5][1]).max());
}
