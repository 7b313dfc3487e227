//! The paper's lake under the moon (its figures 8 and 9), drawn three times: with plain normal mips, with a portable bake
//! and supersampled. Writes `docs/pictures/lake.png`, or the file named on the command line.
//!
//! cargo run --release --example lake

use std::f32::consts::TAU;
use std::path::PathBuf;

use rayon::prelude::*;
use roughcast::bake::{Model, OwnRoughness, Relief, Settings, bake_map, encode_png, write_file};
use roughcast::bump::{Offset, Wrap, normal_from_offset};
use roughcast::lobe::{Anisotropy, Roughness};
use roughcast::map::{HeightMap, Image, Samples};
use roughcast::pyramid::{Level, Moments, Pyramid};
use roughcast::symmetric::Symmetric2;
use roughcast::texture::ktx2::Ktx2;
use roughcast::texture::uastc::Effort;

/// Texels of the wave map along each side.
const MAP: u32 = 512;
/// Pixels of one panel.
const PANEL: [u32; 2] = [360, 420];
/// Repeats of the map per height of the eye.
const REPEATS: f32 = 0.7;
/// Roughness of the water between the waves.
const WATER: f32 = 0.14;
/// Samples per pixel of the supersampled panel, along each side.
const SAMPLES: u32 = 32;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let heights = waves();
    let image = Image { width: MAP, height: MAP, channels: 1, samples: Samples::F32(heights) };
    let relief = Relief::Heights { map: HeightMap::new(image)?, slope_per_step: [1.0; 2], wrap: [Wrap::Repeat; 2] };
    let settings = Settings { model: Model::Anisotropic, ..Settings::default() };
    let own = OwnRoughness { image: None, factor: WATER };
    let baked = bake_map(&relief, Some(&own), &settings)?;
    let files: Vec<Vec<u8>> = baked.textures.iter().map(|t| t.chain.to_ktx2(&[], Effort::Fast)).collect();
    let baked = files.iter().map(|file| levels(file)).collect::<Result<Vec<_>, _>>()?;
    let plain = normals(&Pyramid::new(&relief));

    let constant = |[x, y, z]: [f32; 3]| Surface::new([x, y, z], [WATER, 0.0, 0.0, 0.0]);
    let panels = [
        panel(1, &|at, footprint| {
            constant(filter(at, footprint, plain.len(), &|level, x, y| wrapped(&plain[level], x, y)))
        }),
        panel(1, &|at, footprint| {
            let sample = |texture: &[Level<[f32; 3]>]| {
                filter(at, footprint, texture.len(), &|level, x, y| wrapped(&texture[level], x, y))
            };
            let normal = sample(&baked[0]).map(|v| 2.0 * v - 1.0);
            let [_, roughness, _] = sample(&baked[1]);
            let [u, v, strength] = sample(&baked[2]);
            Surface::new(normal, [roughness, strength, 2.0 * u - 1.0, 2.0 * v - 1.0])
        }),
        panel(SAMPLES, &|at, _| {
            let [x, y] = at.map(|t| (t * MAP as f32).floor() as i64);
            constant(wrapped(&plain[0], x, y))
        }),
    ];
    let path = std::env::args().nth(1).map_or_else(|| PathBuf::from("docs/pictures/lake.png"), PathBuf::from);
    let (rgba, width, height) = side_by_side(&panels);
    write_file(&path, &encode_png(&rgba, width, height)?)?;
    println!("{}: plain mips, baked, {} samples per pixel", path.display(), SAMPLES * SAMPLES);
    for (name, panel) in ["plain mips", "baked"].iter().zip(&panels) {
        println!("mean absolute difference to the supersampled panel, {name}: {:.4}", difference(panel, &panels[2]));
    }
    Ok(())
}

/// Periodic waves: sines of all directions within 60 degrees of the wind, heights falling with frequency.
fn waves() -> Vec<f32> {
    let mut state = 7u32;
    let mut random = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 8) as f32 / (1 << 24) as f32
    };
    let sines: Vec<[f32; 4]> = (0..60)
        .map(|i| {
            let frequency = 3.0 * 1.055f32.powi(i);
            let direction = (random() - 0.5) * TAU / 3.0 + TAU / 4.0;
            let (u, v) = ((frequency * direction.cos()).round(), (frequency * direction.sin()).round());
            [u, v, random() * TAU, 3.0 / (u * u + v * v).max(1.0).sqrt()]
        })
        .collect();
    (0..MAP * MAP)
        .into_par_iter()
        .map(|i| {
            let (x, y) = ((i % MAP) as f32 / MAP as f32, (i / MAP) as f32 / MAP as f32);
            sines.iter().map(|[u, v, phase, height]| height * (TAU * (u * x + v * y) + phase).sin()).sum()
        })
        .collect()
}

/// Levels of a KTX2 file as an engine decodes them.
fn levels(file: &[u8]) -> Result<Vec<Level<[f32; 3]>>, Box<dyn std::error::Error>> {
    let file = Ktx2::parse(file)?;
    let mut levels = Vec::new();
    for level in 0..file.level_count() {
        let image = file.decode_level(level)?;
        let (width, height) = (image.width, image.height);
        let texel = |i: u32| [0, 1, 2].map(|c| image.sample(i % width, i / width, c).unwrap_or(0.0));
        levels.push(Level { width, height, texels: (0..width * height).map(texel).collect() });
    }
    Ok(levels)
}

/// Plain normal mips: the mean, renormalised.
fn normals(pyramid: &Pyramid<&Relief>) -> Vec<Level<[f32; 3]>> {
    let of_level = |(level, (width, height)): (usize, (u32, u32))| {
        let row = |y| {
            let mut moments = vec![Moments::default(); width as usize];
            pyramid.row(level, y, &mut moments);
            moments.into_iter().map(|m| normal_from_offset(m.mean))
        };
        Level { width, height, texels: (0..height).flat_map(row).collect() }
    };
    pyramid.sizes().into_iter().enumerate().map(of_level).collect()
}

fn wrapped(level: &Level<[f32; 3]>, x: i64, y: i64) -> [f32; 3] {
    let (width, height) = (i64::from(level.width), i64::from(level.height));
    level.texels[(y.rem_euclid(height) * width + x.rem_euclid(width)) as usize]
}

/// A point of the water as a shader sees it.
struct Surface {
    normal: [f32; 3],
    lobe: Symmetric2,
}

impl Surface {
    /// `lobe` is roughness, strength and direction.
    fn new(normal: [f32; 3], [roughness, strength, x, y]: [f32; 4]) -> Self {
        let length = (x * x + y * y).sqrt();
        let direction = if length > 0.0 { [x / length, y / length] } else { [1.0, 0.0] };
        let lobe = Anisotropy { roughness: Roughness(roughness), strength, direction }.squared_alpha().0;
        let length = normal.iter().map(|n| n * n).sum::<f32>().sqrt();
        Self { normal: normal.map(|n| n / length), lobe }
    }

    /// GGX of the half-vector in the frame of the normal, times a share for Fresnel and the cosine.
    fn reflect(&self, view: [f32; 3], light: [f32; 3]) -> f32 {
        let half = unit([view[0] + light[0], view[1] + light[1], view[2] + light[2]]);
        let tangent = unit([self.normal[2], 0.0, -self.normal[0]]);
        let bitangent = cross(self.normal, tangent);
        let z = dot(half, self.normal).max(1e-4);
        let slope = Offset { u: dot(half, tangent) / z, v: dot(half, bitangent) / z };
        let a = self.lobe;
        let det = a.determinant().max(1e-12);
        let q = (a.vv * slope.u * slope.u - 2.0 * a.uv * slope.u * slope.v + a.uu * slope.v * slope.v) / det;
        let density = 1.0 / (std::f32::consts::PI * det.sqrt() * (1.0 + q) * (1.0 + q) * z.powi(4));
        let fresnel = 0.02 + 0.98 * (1.0 - dot(view, half).clamp(0.0, 1.0)).powi(5);
        density * fresnel * dot(self.normal, light).max(0.0)
    }
}

/// Renders a panel with `samples` squared samples per pixel. `surface` returns the water at a place (in repeats of the
/// map), given the pixel's footprint: its longer axis, and the length of its shorter one.
fn panel(samples: u32, surface: &(dyn Fn([f32; 2], ([f32; 2], f32)) -> Surface + Sync)) -> Vec<f32> {
    let [width, height] = PANEL;
    let light = unit([0.0, 1.0, 0.42]);
    let eye_height = 1.0;
    let horizon = 0.12;
    let ray = |x: f32, y: f32| unit([(x / width as f32 - 0.5) * 0.9, 1.0, (horizon - y / height as f32) * 0.9]);
    let hit = |x: f32, y: f32| {
        let ray = ray(x, y);
        let t = eye_height / -ray[2].min(-1e-3);
        [ray[0] * t * REPEATS, ray[1] * t * REPEATS]
    };
    (0..width * height)
        .into_par_iter()
        .map(|i| {
            let (x, y) = ((i % width) as f32, (i / width) as f32);
            if y < horizon * height as f32 + 1.0 {
                let away = dot(ray(x + 0.5, y + 0.5), unit([light[0], light[1], 0.075]));
                return if away > 0.99985 { 8.0 } else { 0.015 };
            }
            let mut sum = 0.0;
            for s in 0..samples * samples {
                let offset = |k: u32| (k as f32 + 0.5) / samples as f32;
                let (px, py) = (x + offset(s % samples), y + offset(s / samples));
                let at = hit(px, py);
                let down = hit(px, py + 0.5);
                let up = hit(px, py - 0.5);
                let axis = [down[0] - up[0], down[1] - up[1]];
                let across = hit(px + 0.5, py)[0] - hit(px - 0.5, py)[0];
                let view = ray(px, py).map(|v| -v);
                sum += surface(at, (axis, across.abs())).reflect(view, light).min(1e4);
            }
            let light = 0.8 * sum / (samples * samples) as f32;
            0.01 + light
        })
        .collect()
}

/// Anisotropic filtering as hardware does it: up to 16 trilinear taps along the longer axis of the footprint.
fn filter(
    at: [f32; 2],
    (axis, across): ([f32; 2], f32),
    level_count: usize,
    texel: &dyn Fn(usize, i64, i64) -> [f32; 3],
) -> [f32; 3] {
    let long = (axis[0] * axis[0] + axis[1] * axis[1]).sqrt().max(across);
    let taps = (long / across.max(1e-6)).ceil().clamp(1.0, 16.0);
    let level = ((long / taps) * MAP as f32).max(1.0).log2().min(level_count as f32 - 1.0);
    let (fine, blend) = (level.floor() as usize, level.fract());
    let mut sum = [0.0; 3];
    for tap in 0..taps as u32 {
        let t = (tap as f32 + 0.5) / taps - 0.5;
        let place = [at[0] + axis[0] * t, at[1] + axis[1] * t];
        for (level, share) in [(fine, 1.0 - blend), ((fine + 1).min(level_count - 1), blend)] {
            let size = (MAP >> level).max(1) as f32;
            let (x, y) = (place[0] * size - 0.5, place[1] * size - 0.5);
            let (fx, fy) = (x - x.floor(), y - y.floor());
            for (dx, dy, weight) in
                [(0, 0, (1.0 - fx) * (1.0 - fy)), (1, 0, fx * (1.0 - fy)), (0, 1, (1.0 - fx) * fy), (1, 1, fx * fy)]
            {
                let value = texel(level, x.floor() as i64 + dx, y.floor() as i64 + dy);
                for (sum, value) in sum.iter_mut().zip(value) {
                    *sum += share * weight * value / taps;
                }
            }
        }
    }
    sum
}

fn side_by_side(panels: &[Vec<f32>; 3]) -> (Vec<u8>, u32, u32) {
    const GAP: u32 = 6;
    let [width, height] = PANEL;
    let total = 3 * width + 2 * GAP;
    let mut rgba = vec![255; (total * height * 4) as usize];
    for (index, panel) in panels.iter().enumerate() {
        for (i, light) in panel.iter().enumerate() {
            let (x, y) = (i as u32 % width + index as u32 * (width + GAP), i as u32 / width);
            let texel = &mut rgba[((y * total + x) * 4) as usize..][..3];
            for (value, tint) in texel.iter_mut().zip([0.86, 0.94, 1.0]) {
                *value = (shown(light * tint) * 255.0).round() as u8;
            }
        }
    }
    (rgba, total, height)
}

/// Tone curve and display gamma.
fn shown(light: f32) -> f32 {
    (light / (1.0 + light)).powf(1.0 / 2.2)
}

fn difference(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (shown(*a) - shown(*b)).abs()).sum::<f32>() / a.len() as f32
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(a: [f32; 3]) -> [f32; 3] {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}
