//! UASTC blocks from texels, and zstd of them, beside a copy of as many bytes: `cargo bench --bench encoder`.

use divan::counter::{BytesCount, ItemsCount};
use divan::{Bencher, black_box};
use roughcast::texture::Format;
use roughcast::texture::ktx2::StoredLevel;
use roughcast::texture::uastc::{Effort, Metric, encode_level};

mod common;

fn main() {
    divan::main();
}

fn rgba(rgb: &[u8]) -> Vec<u8> {
    rgb.as_chunks::<3>().0.iter().flat_map(|&[r, g, b]| [r, g, b, 255]).collect()
}

fn encode(bencher: Bencher, rgb: &[u8], metric: Metric, effort: Effort) {
    let (size, texels) = (common::size() as u32, rgba(rgb));
    bencher
        .counter(ItemsCount::new(texels.len() / 4))
        .bench(|| encode_level(black_box(&texels), size, size, metric, effort));
}

/// RGBA8 read, a byte a texel written.
#[divan::bench(sample_count = 20)]
fn copy(bencher: Bencher) {
    let texels = common::size() * common::size();
    common::bench_copy(bencher, 4 * texels, texels);
}

#[divan::bench(sample_count = 5)]
fn normals_fast(bencher: Bencher) {
    encode(bencher, &common::maps::normals(common::size()), Metric::Direction, Effort::Fast);
}

#[divan::bench(sample_count = 1)]
fn normals_best(bencher: Bencher) {
    encode(bencher, &common::maps::normals(common::size()), Metric::Direction, Effort::Best);
}

#[divan::bench(sample_count = 5)]
fn roughness_fast(bencher: Bencher) {
    encode(bencher, &common::maps::surface(common::size()), Metric::Surface, Effort::Fast);
}

#[divan::bench(sample_count = 1)]
fn roughness_best(bencher: Bencher) {
    encode(bencher, &common::maps::surface(common::size()), Metric::Surface, Effort::Best);
}

#[divan::bench(sample_count = 5)]
fn zstd(bencher: Bencher) {
    let size = common::size() as u32;
    let texels = rgba(&common::maps::normals(common::size()));
    let level = encode_level(&texels, size, size, Metric::Direction, Effort::Fast);
    bencher
        .counter(BytesCount::new(level.len()))
        .with_inputs(|| level.clone())
        .bench_values(|level| StoredLevel::new(level, Format::UastcRgb, Effort::Fast));
}
