//! Prints what codes of offsets and of D add to the lobe error of the pyramid profile in UASTC, as markdown.
//!
//! `cargo run --release -p studies --bin pyramid_coding [TEXELS]` uses TEXELS texels per level and map, 64 by default.
//! It reads crops of `../shared/data/maps`, where they are present, and generates maps with steep outliers.

use std::error::Error;
use std::path::Path;

use roughcast::bake::{BaseRoughness, bake_map};
use roughcast::bump::{NormalLayout, NormalMap};
use roughcast::codec::uastc::{Effort, Metric};
use roughcast::codec::{PayloadFormat, Target, Texels, encode};
use roughcast::decode::decode;
use roughcast::image::{DecodeOptions, Image, Samples};
use roughcast::ktx2::{Ktx2, Ktx2Writer, StoredLevel};
use roughcast::lobe::{Alpha, Factor, Family, Roughness, SquaredAlpha};
use roughcast::material::{BumpMap, byte_scale};
use roughcast::math::symmetric::Symmetric2;
use roughcast::metric::{Decoded, Lobe, Surface, mean_errors, sample_texels};
use roughcast::report::Content;
use roughcast::settings::{Model, Settings};

const MAPS: [&str; 5] =
    ["aluminium_normal.png", "wool_normal.png", "sand_normal.jpg", "texture_bricks_normal.jpg", "water_normals.png"];
/// Texels along a side of a crop and of a generated map.
const SIDE: u32 = 512;
const ALPHAS: [f32; 2] = [0.05, 0.2];
const LEVELS: std::ops::RangeInclusive<u32> = 1..=5;

/// Where the errors of codes of D begin: after those of offsets.
const FACTORS: usize = 1 + 24;
/// Where the errors of isotropic lobes begin.
const ISOTROPIC: usize = FACTORS + 7;
const COLUMNS: usize = ISOTROPIC + 2;

/// A code of values as three texel channels in [0, 1].
struct Code<const N: usize> {
    name: String,
    metric: Metric,
    encode: Box<dyn Fn([f64; N]) -> [f64; 3] + Sync>,
    decode: Box<dyn Fn([f64; 3]) -> [f64; N] + Sync>,
}

/// Returns a code of these functions.
fn code<const N: usize>(
    name: impl Into<String>,
    metric: Metric,
    encode: impl Fn([f64; N]) -> [f64; 3] + Sync + 'static,
    decode: impl Fn([f64; 3]) -> [f64; N] + Sync + 'static,
) -> Code<N> {
    Code { name: name.into(), metric, encode: Box::new(encode), decode: Box::new(decode) }
}

/// Returns the value below which `share` of `values` lie.
fn quantile(values: impl Iterator<Item = f64>, share: f64) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get((share * (values.len().max(1) - 1) as f64) as usize).copied().unwrap_or(1.0).max(1e-6)
}

fn offset_codes(offsets: &[[f64; 2]]) -> Vec<Code<2>> {
    let axis = |c: usize, share: f64| quantile(offsets.iter().map(move |f| f[c].abs()), share);
    let length = |share: f64| quantile(offsets.iter().map(|f| f[0].hypot(f[1])), share);
    let linear = |name: &str, share: f64| {
        let max = [axis(0, share), axis(1, share)];
        code(
            name,
            Metric::Rgb,
            move |f: [f64; 2]| [0.5 + 0.5 * f[0] / max[0], 0.5 + 0.5 * f[1] / max[1], 0.0],
            move |t| [0, 1].map(|c| (2.0 * t[c] - 1.0) * max[c]),
        )
    };
    let normal = |name: String, s: f64, metric: Metric, has_z: bool| {
        code(
            name,
            metric,
            move |f: [f64; 2]| {
                let g = f.map(|f| f / s);
                let z = 1.0 / (1.0 + g[0] * g[0] + g[1] * g[1]).sqrt();
                [0.5 - 0.5 * g[0] * z, 0.5 - 0.5 * g[1] * z, if has_z { 0.5 + 0.5 * z } else { 0.0 }]
            },
            move |t| {
                let [x, y, z] = t.map(|t| 2.0 * t - 1.0);
                let z = if has_z { z } else { (1.0 - x * x - y * y).max(0.0).sqrt() };
                let z = z.max(1.0 / 32.0);
                [-s * x / z, -s * y / z]
            },
        )
    };
    let radial = |name: String, s: f64| {
        code(
            name,
            Metric::Rgb,
            move |f: [f64; 2]| {
                let k = 0.5 / (s + f[0].hypot(f[1]));
                [0.5 + k * f[0], 0.5 + k * f[1], 0.0]
            },
            move |t| {
                let [x, y] = [2.0 * t[0] - 1.0, 2.0 * t[1] - 1.0];
                let k = s / (1.0 - x.hypot(y)).max(0.01);
                [k * x, k * y]
            },
        )
    };
    let per_axis = |name: String, s: f64| {
        code(
            name,
            Metric::Rgb,
            move |f: [f64; 2]| {
                let [x, y] = f.map(|f| 0.5 + 0.5 * f / (s + f.abs()));
                [x, y, 0.0]
            },
            move |t| [0, 1].map(|c| 2.0 * t[c] - 1.0).map(|x: f64| s * x / (1.0 - x.abs()).max(0.01)),
        )
    };
    let sine = |f: &[f64; 2]| (f[0] * f[0] + f[1] * f[1]) / (1.0 + f[0] * f[0] + f[1] * f[1]);
    let share = offsets.iter().map(sine).sum::<f64>() / offsets.len() as f64;
    let best = (share / (1.0 - share)).sqrt().max(1e-6);
    let mut codes = vec![linear("linear, max", 1.0), linear("linear, 99.9 %", 0.999), linear("linear, 99 %", 0.99)];
    let scales = [("1", 1.0), ("q90", length(0.9)), ("best / 2", 0.5 * best), ("best", best), ("2 best", 2.0 * best)];
    for (name, s) in scales {
        codes.push(normal(format!("xyz by direction, s = {name}"), s, Metric::Direction, true));
        codes.push(normal(format!("xy, s = {name}"), s, Metric::Rgb, false));
        codes.push(radial(format!("f / (s + \\|f\\|), s = {name}"), s));
        codes.push(per_axis(format!("f / (s + \\|f\\|) by axis, s = {name}"), s));
    }
    let kept = f64::from(byte_scale(2.0 * best as f32));
    codes.push(normal("xyz by direction, s = 1, 1/3, ... next to 2 best".to_owned(), kept, Metric::Direction, true));
    codes
}

fn factor_codes(factors: &[[f64; 3]]) -> Vec<Code<3>> {
    let axis = |c: usize, share: f64| quantile(factors.iter().map(move |d| d[c].abs()), share);
    let all = |share: f64| quantile(factors.iter().flatten().map(|d| d.abs()), share);
    let linear = |name: &str, share: f64| {
        let max = [0, 1, 2].map(|c| axis(c, share));
        code(
            name,
            Metric::Rgb,
            move |d: [f64; 3]| [d[0] / max[0], 0.5 + 0.5 * d[1] / max[1], d[2] / max[2]],
            move |t| [t[0] * max[0], (2.0 * t[1] - 1.0) * max[1], t[2] * max[2]],
        )
    };
    let companded = |name: &str, s: f64| {
        let max = [0, 1, 2].map(|c| axis(c, 1.0)).map(|m| m / (s + m));
        code(
            name,
            Metric::Rgb,
            move |d: [f64; 3]| {
                let g = [0, 1, 2].map(|c| d[c] / (s + d[c].abs()) / max[c]);
                [g[0], 0.5 + 0.5 * g[1], g[2]]
            },
            move |t| {
                let g = [t[0] * max[0], (2.0 * t[1] - 1.0) * max[1], t[2] * max[2]];
                g.map(|g| s * g / (1.0 - g.abs()).max(0.01))
            },
        )
    };
    let root = {
        let max = [0, 1, 2].map(|c| axis(c, 1.0));
        code(
            "square root",
            Metric::Rgb,
            move |d: [f64; 3]| {
                let g = [0, 1, 2].map(|c| d[c].signum() * (d[c].abs() / max[c]).sqrt());
                [g[0], 0.5 + 0.5 * g[1], g[2]]
            },
            move |t| {
                let g = [t[0], 2.0 * t[1] - 1.0, t[2]];
                [0, 1, 2].map(|c| g[c] * g[c].abs() * max[c])
            },
        )
    };
    vec![
        linear("linear, max", 1.0),
        linear("linear, 99.9 %", 0.999),
        linear("linear, 99 %", 0.99),
        companded("d/(1+d)", 1.0),
        companded("d/(q90+d)", all(0.9)),
        companded("d/(2 q90+d)", 2.0 * all(0.9)),
        root,
    ]
}

fn main() -> Result<(), Box<dyn Error>> {
    let texels = std::env::args().nth(1).map_or(Ok(64), |n| n.parse::<usize>())?;
    let folder = Path::new("../shared/data/maps");
    let mut images = Vec::new();
    for name in MAPS.iter().filter(|name| folder.join(name).is_file()) {
        let image = decode(&std::fs::read(folder.join(name))?, &DecodeOptions::default())?;
        images.push((name.split('_').next().unwrap_or(name).to_owned(), cropped(&image)));
    }
    for (deviation, share) in [(0.05, 0.01), (0.15, 0.02), (0.4, 0.01)] {
        images.push((format!("noise {deviation}, {} % steep", 100.0 * share), generated(deviation, share)));
    }
    images.push(("noise 0.02".to_owned(), generated(0.02, 0.0)));
    let mut tables = [Vec::new(), Vec::new(), Vec::new()];
    for (name, image) in &images {
        for alpha in ALPHAS {
            eprintln!("{name}, {alpha}");
            for (table, columns) in tables.iter_mut().zip(errors(image, alpha, texels)?) {
                table.push((format!("{name}, {alpha}"), columns));
            }
        }
    }
    tables.iter().for_each(|table| print_table(table));
    Ok(())
}

/// Mean errors by code.
type Columns = Vec<(String, f64)>;

/// Prints codes as rows, maps as columns.
fn print_table(table: &[(String, Columns)]) {
    print!("| code |");
    table.iter().for_each(|(map, _)| print!(" {map} |"));
    println!(" mean |\n|---|{}---|", "---|".repeat(table.len()));
    for (row, (code, _)) in table[0].1.iter().enumerate() {
        print!("| {code} |");
        table.iter().for_each(|(_, columns)| print!(" {:.3} |", columns[row].1));
        println!(" {:.4} |", table.iter().map(|(_, columns)| columns[row].1).sum::<f64>() / table.len() as f64);
    }
    println!();
}

fn cropped(image: &Image) -> Image {
    let (width, height) = (image.width.min(SIDE), image.height.min(SIDE));
    let mut samples = Vec::new();
    for y in 0..height {
        for x in 0..width {
            samples.extend((0..3).map(|c| (image.sample(x, y, c).unwrap_or(0.0) * 255.0).round() as u8));
        }
    }
    Image { width, height, channels: 3, samples: Samples::U8(samples) }
}

/// Returns smooth noise of slopes with `deviation`, of whose texels `share` are as steep as slopes can be, in clumps.
fn generated(deviation: f64, share: f64) -> Image {
    let mut state = 1_u64;
    let mut random = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let waves: Vec<[f64; 5]> = (0..64)
        .map(|_| {
            let (radius, angle) = (4.0 + 60.0 * random(), std::f64::consts::TAU * random());
            let frequency = [(radius * angle.cos()).round(), (radius * angle.sin()).round()];
            [frequency[0], frequency[1], std::f64::consts::TAU * random(), angle.cos(), angle.sin()]
        })
        .collect();
    let mut samples = Vec::new();
    let mut steep = 0;
    let mut direction = [0.0; 2];
    for y in 0..SIDE {
        for x in 0..SIDE {
            let (u, v) = (f64::from(x) / f64::from(SIDE), f64::from(y) / f64::from(SIDE));
            let mut f = [0.0; 2];
            for [a, b, phase, cos, sin] in &waves {
                let h = deviation * (std::f64::consts::TAU * (a * u + b * v) + phase).sin() / 32_f64.sqrt();
                f = [f[0] + 1.4 * h * cos, f[1] + 1.4 * h * sin];
            }
            if steep == 0 && random() < share / 8.0 {
                let angle = std::f64::consts::TAU * random();
                (steep, direction) = (8, [30.0 * angle.cos(), 30.0 * angle.sin()]);
            }
            if steep > 0 {
                (steep, f) = (steep - 1, direction);
            }
            let z = 1.0 / (1.0 + f[0] * f[0] + f[1] * f[1]).sqrt();
            samples.extend([-f[0] * z, -f[1] * z, z].map(|c| (127.5 + 127.5 * c).round() as u8));
        }
    }
    Image { width: SIDE, height: SIDE, channels: 3, samples: Samples::U8(samples) }
}

/// A level: its normals as offsets, and its squared alphas.
struct Level {
    size: (u32, u32),
    offsets: Vec<[f64; 2]>,
    lobes: Vec<[f64; 3]>,
}

/// Returns the errors, averaged over levels, of codes of offsets, of codes of D, and of isotropic lobes.
fn errors(image: &Image, alpha: f32, texels: usize) -> Result<[Columns; 3], Box<dyn Error>> {
    let map = || NormalMap::new(image.clone(), NormalLayout::Auto, false);
    let base = SquaredAlpha::isotropic(Alpha(alpha));
    let surface = Surface::of_map(&map()?, base);
    let levels = levels(&BumpMap::Normals(map()?), alpha, image)?;
    let factor = |a: &[f64; 3]| {
        let [uu, uv, vv] = a.map(|a| a as f32);
        let e = (SquaredAlpha(Symmetric2::new(uu, uv, vv)).0 + -1.0 * base.0).eigen();
        let k = Symmetric2::from_axes((0.5 * e.major).max(0.0), 0.5 * e.minor, e.axis);
        let Factor { d1, d2, d3 } = Factor::of(k);
        [d1, d2, d3].map(f64::from)
    };
    let all_offsets: Vec<_> = levels.iter().flat_map(|level| level.offsets.iter().copied()).collect();
    let all_factors: Vec<_> = levels.iter().flat_map(|level| level.lobes.iter().map(factor)).collect();
    let (offset_codes, factor_codes) = (offset_codes(&all_offsets), factor_codes(&all_factors));
    let mut tables = [
        named(offset_codes.iter().map(|code| code.name.as_str())),
        named(factor_codes.iter().map(|code| code.name.as_str())),
        named(["closest isotropic", "larger eigenvalue"].into_iter()),
    ];
    let squared = f64::from(alpha * alpha);
    for index in LEVELS {
        let level = &levels[index as usize];
        let offsets = offset_codes.iter().map(|code| coded(code, &level.offsets, level.size));
        let offsets = offsets.collect::<Result<Vec<_>, _>>()?;
        let factors: Vec<_> = level.lobes.iter().map(factor).collect();
        let factors = factor_codes.iter().map(|code| coded(code, &factors, level.size));
        let factors = factors.collect::<Result<Vec<_>, _>>()?;
        let sampled = sample_texels(level.size, texels);
        let means = mean_errors(&surface, Family::Ggx, level.size, &sampled, |(x, y), _, reference| {
            let at = (y * level.size.0 + x) as usize;
            let error = |[u, v]: [f64; 2], a| reference.error(&Lobe::new(Family::Ggx, [-u, -v, 1.0], a));
            let (offset, a) = (level.offsets[at], level.lobes[at]);
            let mut errors = [0.0; COLUMNS];
            errors[0] = error(offset, a);
            for (out, offsets) in errors[1..].iter_mut().zip(&offsets) {
                *out = error(offsets[at], a);
            }
            for (out, factors) in errors[FACTORS..].iter_mut().zip(&factors) {
                let [d1, d2, d3] = factors[at];
                *out = error(offset, [squared + 2.0 * (d1 * d1 + d2 * d2), 2.0 * d2 * d3, squared + 2.0 * d3 * d3]);
            }
            let determinant = (a[0] * a[2] - a[1] * a[1]).max(0.0).sqrt();
            let major = 0.5 * (a[0] + a[2]) + (0.5 * (a[0] - a[2])).hypot(a[1]);
            for (out, a) in errors[ISOTROPIC..].iter_mut().zip([determinant.max(squared), major]) {
                *out = error(offset, [a, 0.0, a]);
            }
            errors
        });
        let count = LEVELS.count() as f64;
        for (table, first) in tables.iter_mut().zip([1, FACTORS, ISOTROPIC]) {
            table[0].1 += means[0] / count;
            table[1..].iter_mut().zip(&means[first..]).for_each(|((_, sum), error)| *sum += error / count);
        }
    }
    Ok(tables)
}

fn named<'n>(names: impl Iterator<Item = &'n str>) -> Columns {
    std::iter::once("exact").chain(names).map(|name| (name.to_owned(), 0.0)).collect()
}

/// Returns all levels of a bake in half floats.
fn levels(bump_map: &BumpMap, alpha: f32, image: &Image) -> Result<Vec<Level>, Box<dyn Error>> {
    let base = BaseRoughness { image: None, factor: Roughness::from(Alpha(alpha)).0 };
    let settings = Settings::default().with_model(Model::Anisotropic).with_target(Target::Float).with_provenance(false);
    let baked = bake_map(bump_map, Some(&base), &settings)?;
    let files = baked.textures.iter().map(|t| Ok((t.content, t.mip_chain.to_ktx2(&[])?)));
    let files = files.collect::<Result<Vec<_>, Box<dyn Error>>>()?;
    let count = image.width.max(image.height).ilog2() + 1;
    (0..count)
        .map(|level| {
            let of = |content| -> Result<Option<Image>, Box<dyn Error>> {
                let file = files.iter().find(|f| f.0 == content);
                file.map(|(_, bytes)| Ok(Ktx2::parse(bytes)?.decode_level(level)?)).transpose()
            };
            let normal = of(Content::Normal)?.ok_or("the bake has no normals")?;
            let size = (normal.width, normal.height);
            let decoded = Decoded {
                normal,
                roughness: of(Content::Roughness)?,
                roughness_factor: 1.0,
                anisotropy: of(Content::Anisotropy)?,
            };
            let texels = (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y)));
            let lobes: Vec<_> = texels.filter_map(|(x, y)| decoded.lobe(Family::Ggx, x, y)).collect();
            let offset = |lobe: &Lobe| {
                let [x, y, z] = lobe.normal();
                [-x / z.max(0.06), -y / z.max(0.06)]
            };
            let offsets = lobes.iter().map(offset).collect();
            Ok(Level { size, offsets, lobes: lobes.iter().map(Lobe::squared_alpha).collect() })
        })
        .collect()
}

/// Encodes and decodes the values of a level.
fn coded<const N: usize>(
    code: &Code<N>,
    values: &[[f64; N]],
    (width, height): (u32, u32),
) -> Result<Vec<[f64; N]>, Box<dyn Error>> {
    let row = |y: u32, out: &mut [[f32; 4]]| {
        for (texel, value) in out.iter_mut().zip(&values[(y * width) as usize..]) {
            let [r, g, b] = (code.encode)(*value).map(|c| c as f32);
            *texel = [r, g, b, 1.0];
        }
    };
    let format = PayloadFormat::UastcRgb;
    let level = encode(&Texels { width, height, row: &row, lobes: None }, format, code.metric, Effort::Fast)?;
    let levels = vec![StoredLevel::new(level, format, Effort::Fast)?];
    let file = Ktx2Writer { format, width, height, levels, keys: &[] }.into_bytes()?;
    let image = Ktx2::parse(&file)?.decode_level(0)?;
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    Ok(texels.map(|(x, y)| (code.decode)([0, 1, 2].map(|c| f64::from(image.sample(x, y, c).unwrap_or(0.0))))).collect())
}
