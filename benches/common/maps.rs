//! Maps of any size that resemble those of materials: bumps of three scales under a grain that no compressor removes.

use rayon::prelude::*;

use super::noise::{Random, ValueNoise};
use super::picture::{normal, unorm8};

/// Rows of a band, which one thread makes. Slopes need the heights of two rows more.
const BAND: usize = 64;

/// Makes an RGB normal map of `size` x `size` texels that repeats at its borders. The standard deviation of slopes is
/// about 0.25.
pub fn normals(size: usize) -> Vec<u8> {
    let mut random = Random(0x5104_E5D0);
    let octaves =
        [(64, 14.0), (16, 3.5), (4, 0.8)].map(|(texels, depth)| (ValueNoise::new(&mut random, size / texels), depth));
    let heights = |row: usize| -> Vec<f64> {
        let mut grain = Random(row as u64);
        let v = (row as f64 + 0.5) / size as f64;
        let height = |x: usize| {
            let u = (x as f64 + 0.5) / size as f64;
            octaves.iter().map(|(noise, depth)| depth * noise.at(u, v)).sum::<f64>() + 0.2 * grain.unit()
        };
        (0..size).map(height).collect()
    };
    let mut texels = vec![0; size * size * 3];
    texels.par_chunks_mut(size * 3 * BAND).enumerate().for_each(|(band, out)| {
        let first = band * BAND;
        let rows = out.len() / (size * 3);
        let heights: Vec<_> = (0..rows + 2).map(|i| heights((first + i + size - 1) % size)).collect();
        for (rows, out) in heights.windows(3).zip(out.chunks_exact_mut(size * 3)) {
            for (x, texel) in out.as_chunks_mut::<3>().0.iter_mut().enumerate() {
                let right = rows[1][(x + 1) % size] - rows[1][(x + size - 1) % size];
                *texel = normal([0.5 * right, 0.5 * (rows[0][x] - rows[2][x])]);
            }
        }
    });
    texels
}

/// Makes an RGB map of occlusion 1, roughness of about 0.45 and metal 0.
pub fn surface(size: usize) -> Vec<u8> {
    let mut random = Random(0x0005_0FF1);
    let smudges = ValueNoise::new(&mut random, size / 32);
    let mut texels = vec![0; size * size * 3];
    texels.par_chunks_exact_mut(size * 3).enumerate().for_each(|(row, out)| {
        let mut grain = Random(row as u64);
        let v = (row as f64 + 0.5) / size as f64;
        for (x, texel) in out.as_chunks_mut::<3>().0.iter_mut().enumerate() {
            let smudge = smudges.at((x as f64 + 0.5) / size as f64, v);
            *texel = [255, unorm8(0.3 + 0.28 * smudge + 0.02 * grain.unit()), 0];
        }
    });
    texels
}
