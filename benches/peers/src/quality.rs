//! Measures the error of decoded blocks, map by map.

use std::ops::Range;
use std::path::Path;

use roughcast::codec::ORM;
use roughcast::codec::uastc::{Effort, Metric};
use roughcast::image::Image;
use serde_json::{Map, Value, json};

use crate::Failure;
use crate::basisu::{self, Interface};
use crate::encoders::{Encoder, read};

/// The encoders to compare, by their names in the table: for PSNR those that fit colours, for PSNR of green those that
/// fit roughness, for angles those that fit directions.
const ENCODERS: [(&str, Encoder); 9] = [
    ("fast rgb", Encoder::Roughcast(Metric::Rgb, Effort::Fast)),
    ("best rgb", Encoder::Roughcast(Metric::Rgb, Effort::Best)),
    ("fast surface", Encoder::Roughcast(ORM, Effort::Fast)),
    ("best surface", Encoder::Roughcast(ORM, Effort::Best)),
    ("fast", Encoder::Roughcast(Metric::Direction, Effort::Fast)),
    ("best", Encoder::Roughcast(Metric::Direction, Effort::Best)),
    ("level 0", Encoder::Basisu(0, Interface::Plain)),
    ("level 1", Encoder::Basisu(1, Interface::Plain)),
    ("level 2", Encoder::Basisu(2, Interface::Plain)),
];

/// Returns the PSNR of each encoder on each image. Normal maps (by name) also get the angle between normals, and all
/// other maps get the PSNR of green.
///
/// # Errors
/// When an image cannot be read or encoded.
pub fn measure(images: &[&str]) -> Result<Value, Failure> {
    basisu::prepare();
    let mut maps = Map::new();
    for image in images {
        let path = Path::new(image);
        let name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        let is_normal = is_normal_map(&name);
        let (rgba, width, height) = read(path)?;
        let mut row = Map::new();
        for (encoder, of) in ENCODERS {
            let decoded = of.decoded(&rgba, width, height)?;
            let mut found = json!({ "psnr": psnr(&rgba, &decoded, 0..3) });
            if is_normal {
                found["degrees"] = json!(degrees(&rgba, &decoded));
            } else {
                found["green"] = json!(psnr(&rgba, &decoded, 1..2));
            }
            row.insert(encoder.to_owned(), found);
        }
        maps.insert(name, Value::Object(row));
    }
    Ok(Value::Object(maps))
}

/// Returns whether a map of that name holds normals.
fn is_normal_map(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    name.contains("normal") || name.contains("_nor_")
}

/// Returns the source texels and the decoded texels, in [0, 255].
fn pairs<'a>(rgba: &'a [u8], decoded: &'a Image) -> impl Iterator<Item = [[f64; 3]; 2]> + 'a {
    let channels = decoded.channels as usize;
    rgba.as_chunks::<4>().0.iter().enumerate().map(move |(i, texel)| {
        let value = |c: usize| f64::from(decoded.samples.get(i * channels + c).unwrap_or(0.0)) * 255.0;
        [[0, 1, 2].map(|c| f64::from(texel[c])), [0, 1, 2].map(value)]
    })
}

/// PSNR in dB that stands for equal images, above what 8 bits can have.
const EXACT: f64 = 99.0;

/// Returns the PSNR of these channels together, in dB.
fn psnr(rgba: &[u8], decoded: &Image, channels: Range<usize>) -> f64 {
    let square = |[a, b]: [[f64; 3]; 2]| channels.clone().map(|c| (a[c] - b[c]).powi(2)).sum::<f64>();
    let mean = pairs(rgba, decoded).map(square).sum::<f64>() / (rgba.len() / 4 * channels.len()) as f64;
    (10.0 * (255.0 * 255.0 / mean).log10()).min(EXACT)
}

/// Returns the root of the mean squared angle between normals, in degrees.
fn degrees(rgba: &[u8], decoded: &Image) -> f64 {
    let unit = |texel: [f64; 3]| {
        let vector = texel.map(|c| c / 127.5 - 1.0);
        let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
        vector.map(|x| x / length)
    };
    // The angle is computed from the chord, since the cosine loses small angles.
    let square = |[a, b]: [[f64; 3]; 2]| {
        let (a, b) = (unit(a), unit(b));
        let chord = (0..3).map(|c| (a[c] - b[c]).powi(2)).sum::<f64>().sqrt();
        (2.0 * (0.5 * chord).min(1.0).asin()).to_degrees().powi(2)
    };
    (pairs(rgba, decoded).map(square).sum::<f64>() / (rgba.len() / 4) as f64).sqrt()
}
