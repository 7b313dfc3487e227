//! Times the kernels from a normal map to its pyramid, copies of as many bytes, and zstd of UASTC blocks: `cargo bench
//! --bench kernels`.
//!
//! Items are texels of level 0. The copies read and write as many bytes as the kernels do, on the same threads.

use divan::counter::{BytesCount, ItemsCount};
use divan::{Bencher, black_box};
use rayon::prelude::*;
use roughcast::bump::{Moments, NormalLayout, NormalMap, NormalOffsets, Shaped, ShapedMoments};
use roughcast::codec::uastc::{Effort, Encoder, Metric};
use roughcast::codec::{PayloadFormat, uastc};
use roughcast::decode::decode;
use roughcast::image::{DecodeOptions, Image, Samples};
use roughcast::ktx2::StoredLevel;
use roughcast::lobe::{Alpha, OrientedLobe, SquaredAlpha};
use roughcast::mip::{Level, TexelRows, build, level_sizes};

mod common;

fn main() {
    divan::main();
}

fn texels() -> usize {
    common::size() * common::size()
}

/// Returns the number of texels of all levels but level 0.
fn mip_tail_texels() -> usize {
    let size = common::size() as u32;
    level_sizes(size, size)[1..].iter().map(|(width, height)| (width * height) as usize).sum()
}

fn normals() -> NormalMap {
    let size = common::size();
    let samples = Samples::U8(common::maps::normals(size));
    let image = Image { width: size as u32, height: size as u32, channels: 3, samples };
    NormalMap::new(image, NormalLayout::Auto, false).expect("three channels")
}

#[divan::bench(sample_count = 20)]
fn copy_of_mean_and_covariance(bencher: Bencher) {
    common::bench_copy(bencher, 3 * texels(), mip_tail_texels() * size_of::<Moments>());
}

#[divan::bench(sample_count = 20)]
fn copy_of_shape(bencher: Bencher) {
    common::bench_copy(bencher, 3 * texels(), mip_tail_texels() * size_of::<ShapedMoments>());
}

#[divan::bench(sample_count = 5)]
fn png(bencher: Bencher) {
    let size = common::size();
    let file = common::asset::png(&common::maps::normals(size), size);
    bencher.counter(ItemsCount::new(texels())).bench(|| decode(black_box(&file), &DecodeOptions::default()));
}

#[divan::bench(sample_count = 20)]
fn offsets(bencher: Bencher) {
    let map = normals();
    let rows = NormalOffsets::new(&map);
    bencher.counter(ItemsCount::new(texels())).bench(|| {
        let row = |row: &mut Vec<Moments>, y| {
            rows.row(y, row);
            row[0].mean.u
        };
        let empty = || vec![Moments::default(); rows.width() as usize];
        (0..rows.height()).into_par_iter().map_init(empty, row).sum::<f32>()
    });
}

#[divan::bench(sample_count = 20)]
fn mean_and_covariance(bencher: Bencher) {
    let map = normals();
    bencher.counter(ItemsCount::new(texels())).bench(|| build(&NormalOffsets::new(black_box(&map))));
}

#[divan::bench(sample_count = 10)]
fn shape(bencher: Bencher) {
    let map = normals();
    bencher.counter(ItemsCount::new(texels())).bench(|| build(&Shaped(NormalOffsets::new(black_box(&map)))));
}

/// Merges GGX lobes of alpha 0.2 by likelihood.
#[divan::bench(sample_count = 5)]
fn lobes(bencher: Bencher) {
    let map = normals();
    let rows = NormalOffsets::new(&map);
    let (width, height) = (rows.width(), rows.height());
    let mut offsets = vec![Moments::default(); width as usize];
    let mut texels = Vec::new();
    for y in 0..height {
        rows.row(y, &mut offsets);
        let base = SquaredAlpha::isotropic(Alpha(0.2));
        texels.extend(offsets.iter().map(|m| OrientedLobe::new(m.mean, base)));
    }
    let level = Level { width, height, texels };
    bencher.counter(ItemsCount::new(level.texels.len())).bench(|| build(black_box(&level)));
}

#[divan::bench(sample_count = 5)]
fn zstd(bencher: Bencher) {
    let (rgb, size) = (common::maps::normals(common::size()), common::size() as u32);
    let rgba: Vec<u8> = rgb.as_chunks::<3>().0.iter().flat_map(|&[r, g, b]| [r, g, b, 255]).collect();
    let image = uastc::Image::new(&rgba, size, size).expect("texels of that size");
    let level = Encoder::new(Metric::Direction, Effort::Fast).encode(&image).into_flattened();
    bencher
        .counter(BytesCount::new(level.len()))
        .with_inputs(|| level.clone())
        .bench_values(|level| StoredLevel::new(level, PayloadFormat::UastcRgb, Effort::Fast));
}
