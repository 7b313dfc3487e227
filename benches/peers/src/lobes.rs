//! Measures the lobe error of baked normals for the blocks of each encoder. `benches/studies/encoding.rs` does so for
//! Roughcast's own formats.

use std::path::Path;

use roughcast::bake::{BaseRoughness, bake_map};
use roughcast::bump::{NormalLayout, NormalMap};
use roughcast::codec::Target;
use roughcast::codec::uastc::{Effort, Metric};
use roughcast::decode::decode;
use roughcast::image::{DecodeOptions, Image};
use roughcast::ktx2::Ktx2;
use roughcast::lobe::{Alpha, Family, Roughness, SquaredAlpha};
use roughcast::material::BumpMap;
use roughcast::metric::{Decoded, Surface, mean_errors, sample_texels};
use roughcast::report::Content;
use roughcast::settings::{Model, Settings};
use serde_json::{Map, Value, json};

use crate::Failure;
use crate::basisu::{self, Interface};
use crate::encoders::{Encoder, rgba};

/// Alpha of the material.
const ALPHA: f32 = 0.2;
/// Levels that are measured.
const LEVELS: std::ops::RangeInclusive<u32> = 1..=4;
/// Texels of each level that are measured.
const TEXELS: usize = 64;
/// Encoders of the normals.
const ENCODERS: [(&str, Encoder); 4] = [
    ("fast", Encoder::Roughcast(Metric::Direction, Effort::Fast)),
    ("best", Encoder::Roughcast(Metric::Direction, Effort::Best)),
    ("level 0", Encoder::Basisu(0, Interface::Plain)),
    ("level 1", Encoder::Basisu(1, Interface::Plain)),
];
/// Columns: not encoded, then [`ENCODERS`].
const COLUMNS: usize = 1 + ENCODERS.len();

/// Returns the mean lobe error of levels 1 to 4 of each normal map. Roughness and anisotropy are half floats
/// throughout.
///
/// # Errors
/// When an image cannot be read, baked or encoded.
pub fn measure(images: &[&str]) -> Result<Value, Failure> {
    basisu::prepare();
    let mut maps = Map::new();
    for image in images {
        let path = Path::new(image);
        let errors = errors(&decode(&std::fs::read(path)?, &DecodeOptions::default())?)?;
        let mut row = Map::new();
        for (name, error) in std::iter::once("half floats").chain(ENCODERS.map(|e| e.0)).zip(errors) {
            row.insert(name.to_owned(), json!(error));
        }
        maps.insert(path.file_stem().unwrap_or_default().to_string_lossy().into_owned(), Value::Object(row));
    }
    Ok(Value::Object(maps))
}

fn errors(image: &Image) -> Result<[f64; COLUMNS], Failure> {
    let map = || NormalMap::new(image.clone(), NormalLayout::Auto, false);
    let surface = Surface::of_map(&map()?, SquaredAlpha::isotropic(Alpha(ALPHA)));
    let base = BaseRoughness { image: None, factor: Roughness::from(Alpha(ALPHA)).0 };
    let settings = Settings::default().with_model(Model::Anisotropic).with_target(Target::Float).with_provenance(false);
    let baked = bake_map(&BumpMap::Normals(map()?), Some(&base), &settings)?;
    let files: Vec<_> = baked.textures.iter().map(|t| (t.content, t.mip_chain.to_ktx2(&[]).unwrap())).collect();
    let mut sums = [0.0; COLUMNS];
    for level in LEVELS {
        let of = |content| -> Result<Option<Image>, Failure> {
            let file = files.iter().find(|f| f.0 == content);
            file.map(|(_, bytes)| Ok(Ktx2::parse(bytes)?.decode_level(level)?)).transpose()
        };
        let exact = of(Content::Normal)?.ok_or("the bake has no normals")?;
        let size = (exact.width, exact.height);
        let source = rgba(&exact);
        let mut normals = vec![exact];
        for (_, encoder) in ENCODERS {
            normals.push(encoder.decoded(&source, size.0, size.1)?);
        }
        let mut decoded = Vec::new();
        for normal in normals {
            let (roughness, anisotropy) = (of(Content::Roughness)?, of(Content::Anisotropy)?);
            decoded.push(Decoded { normal, roughness, roughness_factor: 1.0, anisotropy });
        }
        let texels = sample_texels(size, TEXELS);
        let means = mean_errors(&surface, Family::Ggx, size, &texels, |(x, y), _, reference| {
            let mut errors = [1.0; COLUMNS];
            for (error, decoded) in errors.iter_mut().zip(&decoded) {
                *error = decoded.lobe(Family::Ggx, x, y).map_or(1.0, |lobe| reference.error(&lobe));
            }
            errors
        });
        sums.iter_mut().zip(means).for_each(|(sum, mean)| *sum += mean);
    }
    Ok(sums.map(|sum| sum / LEVELS.count() as f64))
}
