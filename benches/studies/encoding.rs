//! Prints what block encoding of normals adds to the lobe error, as markdown.
//!
//! `cargo run --release -p studies --bin encoding [TEXELS]` uses TEXELS texels per level and map, 64 by default. It
//! reads `../shared/data/maps`, else `fixtures/maps`.

use std::error::Error;
use std::path::Path;

use roughcast::bake::{BaseRoughness, bake_map};
use roughcast::bump::{NormalLayout, NormalMap};
use roughcast::codec::uastc::{Effort, Lobe, Metric};
use roughcast::codec::{PayloadFormat, Target, Texels, encode};
use roughcast::decode::decode;
use roughcast::image::{DecodeOptions, Image};
use roughcast::ktx2::{Ktx2, Ktx2Writer, StoredLevel};
use roughcast::lobe::{Alpha, Family, Roughness, SquaredAlpha};
use roughcast::material::BumpMap;
use roughcast::metric::{Decoded, Surface, mean_errors, sample_texels, shown_lobe};
use roughcast::report::Content;
use roughcast::settings::{Model, Settings};

const MAPS: [&str; 5] =
    ["aluminium_normal.png", "wool_normal.png", "sand_normal.jpg", "texture_bricks_normal.jpg", "water_normals.png"];
const FIXTURES: [&str; 2] = ["two_channel_normal.png", "vgroove_normal.png"];
const ALPHAS: [f32; 2] = [0.05, 0.2];
const LEVELS: std::ops::RangeInclusive<u32> = 1..=5;
/// UASTC by squared differences of channels, by direction, and by errors of lobes as `bake` encodes it, and BC5.
const ENCODINGS: [(PayloadFormat, Metric, Effort, HasLobes); 7] = [
    (PayloadFormat::UastcRgb, Metric::Rgb, Effort::Fast, false),
    (PayloadFormat::UastcRgb, Metric::Rgb, Effort::Best, false),
    (PayloadFormat::UastcRgb, Metric::Direction, Effort::Fast, false),
    (PayloadFormat::UastcRgb, Metric::Direction, Effort::Best, false),
    (PayloadFormat::UastcRgb, Metric::Direction, Effort::Fast, true),
    (PayloadFormat::UastcRgb, Metric::Direction, Effort::Best, true),
    (PayloadFormat::Bc5, Metric::Direction, Effort::Fast, false),
];
/// Whether the encoder knows the lobes about the normals.
type HasLobes = bool;
/// Columns: half floats and [`ENCODINGS`].
const COLUMNS: usize = 1 + ENCODINGS.len();

fn main() -> Result<(), Box<dyn Error>> {
    let texels = std::env::args().nth(1).map_or(Ok(64), |n| n.parse::<usize>())?;
    let shared = Path::new("../shared/data/maps");
    let folder = if shared.is_dir() { shared } else { Path::new("fixtures/maps") };
    let names: &[&str] = if folder == shared { &MAPS } else { &FIXTURES };
    println!(
        "| map | alpha | level | half floats | channels, fast | channels, best | direction, fast | direction, best | \
         lobes, fast | lobes, best | BC5 |"
    );
    println!("|---|---|---|{}", "---|".repeat(COLUMNS));
    for name in names {
        let image = decode(&std::fs::read(folder.join(name))?, &DecodeOptions::default())?;
        let stem = name.split('.').next().unwrap_or(name);
        for alpha in ALPHAS {
            let levels = errors_by_level(&image, alpha, texels)?;
            let mut mean = [0.0; COLUMNS];
            for (level, errors) in &levels {
                print_row(stem, alpha, &level.to_string(), errors);
                mean.iter_mut().zip(errors).for_each(|(m, e)| *m += e / levels.len() as f64);
            }
            print_row(stem, alpha, "mean", &mean);
        }
    }
    Ok(())
}

fn print_row(map: &str, alpha: f32, level: &str, errors: &[f64; COLUMNS]) {
    print!("| {map} | {alpha} | {level} |");
    errors.iter().for_each(|error| print!(" {error:.3} |"));
    println!();
}

/// A level and its mean errors.
type Row = (u32, [f64; COLUMNS]);

/// Returns the mean errors of each level. Only the normals differ between columns: all lobes are those of half floats.
fn errors_by_level(image: &Image, alpha: f32, texels: usize) -> Result<Vec<Row>, Box<dyn Error>> {
    let map = || NormalMap::new(image.clone(), NormalLayout::Auto, false);
    let surface = Surface::of_map(&map()?, SquaredAlpha::isotropic(Alpha(alpha)));
    let bump_map = BumpMap::Normals(map()?);
    let base = BaseRoughness { image: None, factor: Roughness::from(Alpha(alpha)).0 };
    let settings = Settings::default().with_model(Model::Anisotropic).with_target(Target::Float).with_provenance(false);
    let baked = bake_map(&bump_map, Some(&base), &settings)?;
    let files = baked.textures.iter().map(|t| Ok((t.content, t.mip_chain.to_ktx2(&[])?)));
    let files = files.collect::<Result<Vec<_>, Box<dyn Error>>>()?;
    LEVELS
        .filter(|level| image.width.max(image.height) >> level > 0)
        .map(|level| {
            let of = |content| -> Result<Option<Image>, Box<dyn Error>> {
                let file = files.iter().find(|f| f.0 == content);
                file.map(|(_, bytes)| Ok(Ktx2::parse(bytes)?.decode_level(level)?)).transpose()
            };
            let exact = of(Content::Normal)?.ok_or("the bake has no normals")?;
            let mut normals = vec![exact.clone()];
            let (roughness, anisotropy) = (of(Content::Roughness)?, of(Content::Anisotropy)?);
            let row_of_lobes = |y: u32, out: &mut [Lobe]| {
                for (x, lobe) in out.iter_mut().enumerate() {
                    let sample = |image: &Image, c| image.sample(x as u32, y, c).unwrap_or(1.0);
                    let texel = |image: &Image| [0, 1, 2].map(|c| sample(image, c));
                    let roughness = roughness.as_ref().map_or(1.0, |image| sample(image, 1));
                    let [uu, uv, vv] = shown_lobe(roughness, anisotropy.as_ref().map(texel)).map(|a| a as f32);
                    *lobe = Lobe { uu, uv, vv };
                }
            };
            for (format, metric, effort, has_lobes) in ENCODINGS {
                let lobes = has_lobes.then_some(&row_of_lobes as &LobeRow<'_>);
                normals.push(encoded(&exact, lobes, format, metric, effort)?);
            }
            let mut decoded = Vec::new();
            for normal in normals {
                decoded.push(Decoded {
                    normal,
                    roughness: of(Content::Roughness)?,
                    roughness_factor: 1.0,
                    anisotropy: of(Content::Anisotropy)?,
                });
            }
            let size = (exact.width, exact.height);
            let texels = sample_texels(size, texels);
            let means = mean_errors(&surface, Family::Ggx, size, &texels, |(x, y), _, reference| {
                let mut errors = [1.0; COLUMNS];
                for (error, decoded) in errors.iter_mut().zip(&decoded) {
                    *error = decoded.lobe(Family::Ggx, x, y).map_or(1.0, |lobe| reference.error(&lobe));
                }
                errors
            });
            Ok((level, means))
        })
        .collect()
}

/// Writes the lobes of row `y` of a level.
type LobeRow<'a> = dyn Fn(u32, &mut [Lobe]) + Sync + 'a;

/// Encodes and decodes `normals`.
fn encoded(
    normals: &Image,
    lobes: Option<&LobeRow<'_>>,
    format: PayloadFormat,
    metric: Metric,
    effort: Effort,
) -> Result<Image, Box<dyn Error>> {
    let &Image { width, height, .. } = normals;
    let row = |y: u32, out: &mut [[f32; 4]]| {
        for (x, texel) in out.iter_mut().enumerate() {
            *texel = [0, 1, 2, 3].map(|c| normals.sample(x as u32, y, c).unwrap_or(1.0));
        }
    };
    let level = encode(&Texels { width, height, row: &row, lobes }, format, metric, effort)?;
    let levels = vec![StoredLevel::new(level, format, effort)?];
    let file = Ktx2Writer { format, width, height, levels, keys: &[] }.into_bytes()?;
    Ok(Ktx2::parse(&file)?.decode_level(0)?)
}
