//! Directions of anisotropy: signs that cannot agree, and directions of nearly isotropic lobes.

use std::error::Error;
use std::path::Path;

use roughcast::bake::{BaseRoughness, bake_map};
use roughcast::image::{Image, Samples};
use roughcast::ktx2::Ktx2;
use roughcast::lobe::{Anisotropy, SquaredAlpha};
use roughcast::material::BumpMap;
use roughcast::math::symmetric::Symmetric2;
use roughcast::mip::Level;
use roughcast::note::Note;
use roughcast::report::Content;
use roughcast::settings::{Model, Settings};

use super::picture::{Canvas, write};
use super::synthetic::{Random, level, map, normals};
use super::{head, row};

const SIZE: u32 = 512;
const LEVEL: u32 = 3;

pub fn print(folder: &Path) -> Result<(), Box<dyn Error>> {
    let lathe = level(SIZE, SIZE, |x, y| {
        let [x, y] = [x, y].map(|c| f64::from(c) - 0.5 * f64::from(SIZE - 1));
        let radius = x.hypot(y);
        let slope = if (radius as u32).is_multiple_of(2) { 0.3 } else { -0.3 };
        [slope * x / radius, slope * y / radius]
    });
    let (axes, notes) = baked(&lathe)?;
    head("Directions of grooves around a point", &["", "share of texels"]);
    let (opposed, short) = disagreement(&axes);
    row(&["a neighbour points away".to_owned(), format!("{:.2} %", 100.0 * opposed)]);
    row(&["filtered direction shorter than half".to_owned(), format!("{:.2} %", 100.0 * short)]);
    println!();
    notes.iter().for_each(|note| println!("note: {note}"));

    let mut canvas = Canvas::new(2, 256);
    let texel = |[x, y]: [f64; 2]| {
        let at = |c: f64| ((c * f64::from(axes.width)) as u32).min(axes.width - 1);
        direction(&axes, at(x), at(y))
    };
    canvas.fill(0, |point| {
        let [x, y] = texel(point);
        [0.5 * x + 0.5, 0.5 * y + 0.5, 0.5]
    });
    canvas.fill(1, |point| [filtered_length(&axes, point); 3]);
    write(folder, "stability-signs.png", canvas)?;
    nearly_isotropic_lobes();
    Ok(())
}

/// Returns the level of the anisotropy texture, and the notes of the bake.
fn baked(level: &Level<roughcast::bump::Moments>) -> Result<(Image, Vec<Note>), Box<dyn Error>> {
    let bump_map = BumpMap::Normals(map(SIZE, Samples::F32(normals(level).into_iter().map(|c| c as f32).collect()))?);
    let settings = Settings::default().with_model(Model::Anisotropic);
    let baked = bake_map(&bump_map, Some(&BaseRoughness { image: None, factor: 0.3 }), &settings)?;
    let texture = baked.textures.iter().find(|t| t.content == Content::Anisotropy).ok_or("no anisotropy")?;
    let axes = Ktx2::parse(&texture.mip_chain.to_ktx2(&[])?)?.decode_level(LEVEL)?;
    Ok((axes, baked.notes))
}

fn direction(axes: &Image, x: u32, y: u32) -> [f64; 2] {
    [0, 1].map(|c| 2.0 * f64::from(axes.sample(x, y, c).unwrap_or(0.5)) - 1.0)
}

/// Returns the length of the direction as a sampler filters it at a point of the unit square.
fn filtered_length(axes: &Image, point: [f64; 2]) -> f64 {
    let at = point.map(|c| (c * f64::from(axes.width) - 0.5).clamp(0.0, f64::from(axes.width - 1)));
    let (first, share) = (at.map(|c| c as u32), at.map(f64::fract));
    let mut sum = [0.0; 2];
    for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let weight = |d: u32, share: f64| if d == 1 { share } else { 1.0 - share };
        let texel = |c: u32, d: u32| (c + d).min(axes.width - 1);
        let d = direction(axes, texel(first[0], dx), texel(first[1], dy));
        let weight = weight(dx, share[0]) * weight(dy, share[1]);
        sum = [sum[0] + weight * d[0], sum[1] + weight * d[1]];
    }
    sum[0].hypot(sum[1])
}

/// Returns the share of texels with a neighbour of the opposite direction, and the share of points whose filtered
/// direction is shorter than half.
fn disagreement(axes: &Image) -> (f64, f64) {
    let n = axes.width;
    let (mut opposed, mut short) = (0, 0);
    for i in 0..(n - 1) * (n - 1) {
        let (x, y) = (i % (n - 1), i / (n - 1));
        let here = direction(axes, x, y);
        let away = |[u, v]: [f64; 2]| here[0] * u + here[1] * v < 0.0;
        opposed += u32::from(away(direction(axes, x + 1, y)) || away(direction(axes, x, y + 1)));
        let point = [x, y].map(|c| (f64::from(c) + 1.0) / f64::from(n));
        short += u32::from(filtered_length(axes, point) < 0.5);
    }
    let all = f64::from((n - 1) * (n - 1));
    (f64::from(opposed) / all, f64::from(short) / all)
}

/// Prints the scatter of the directions of lobes that are isotropic but for noise, as eigenvectors and as stored.
fn nearly_isotropic_lobes() {
    head(
        "Directions of nearly isotropic lobes",
        &["axis ratio of the noise", "mean length of eigenvectors", "of stored directions"],
    );
    for noise in [0.001, 0.01, 0.1, 0.3] {
        let mut random = Random(3);
        let (mut plain, mut stored) = ([0.0; 2], [0.0; 2]);
        let count = 10_000;
        for _ in 0..count {
            let angle = std::f64::consts::PI * random.next();
            let axis = [angle.cos() as f32, angle.sin() as f32];
            let ratio = (1.0 + noise) as f32;
            let a = SquaredAlpha(Symmetric2::from_axes(0.09 * ratio * ratio, 0.09, axis));
            let e = a.0.eigen().axis;
            let e = if e[0] < 0.0 { e.map(|c| -c) } else { e };
            let ours = Anisotropy::of(a, [1.0, 0.0]).direction;
            for i in 0..2 {
                plain[i] += f64::from(e[i]) / f64::from(count);
                stored[i] += f64::from(ours[i]) / f64::from(count);
            }
        }
        let length = |[x, y]: [f64; 2]| format!("{:.3}", x.hypot(y));
        row(&[format!("{}", 1.0 + noise), length(plain), length(stored)]);
    }
}
