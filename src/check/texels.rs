//! Decoded levels: finite, and unit normals where normals are stored.

use super::findings::{Code, Findings};
use crate::map::{Image, Rgba, Samples};
use crate::pyramid::Rows;
use crate::texture::ktx2::{Ktx2, ReadError};

/// Largest mean of |n| - 1 over a level, either way. Measured on 13 real normal maps and a height map at every level:
/// UASTC at most 0.012 of normal maps and 0.017 of the height map (1024 x 1024 of wool, level 3), since it is fitted to
/// directions; BC5 and half floats 0.0002; the same normal maps averaged without normalising reach 0.02 to 0.25, but for
/// two that are all but flat (0 and 0.008).
pub const MAX_LENGTH_DEVIATION: f32 = 0.019;

/// Decodes every level and looks at its texels.
pub fn check_texels(file: &Ktx2<'_>, are_normals: bool, findings: &mut Findings) {
    for level in 0..file.level_count() {
        // Told by the level index already.
        if matches!(file.check_length(level), Err(ReadError::LevelLength { .. })) {
            continue;
        }
        let place = format!("level {level}");
        let image = match file.decode_level(level) {
            Ok(image) => image,
            Err(ReadError::LevelLength { expected, found, .. }) => {
                let message = format!("expected {expected} bytes, found {found}; bake again");
                findings.add(Code::LevelLength, place, message);
                continue;
            }
            Err(error) => {
                findings.add(Code::UndecodableLevel, place, format!("expected a level that decodes, found: {error}"));
                continue;
            }
        };
        if let Samples::F32(values) = &image.samples {
            let bad = values.iter().filter(|v| !v.is_finite()).count();
            if bad > 0 {
                findings.add(
                    Code::NotFinite,
                    place,
                    format!("expected finite values, found {bad} that are not; bake again"),
                );
                continue;
            }
        }
        let deviation = if are_normals { length_deviation(&image) } else { 0.0 };
        if deviation.abs() > MAX_LENGTH_DEVIATION {
            let message = format!(
                "expected unit normals, of lengths within {MAX_LENGTH_DEVIATION} of 1 on average, found \
                 {deviation:+.3}: engines that rebuild z and those that do not would disagree; bake again"
            );
            findings.add(Code::NormalLength, place, message);
        }
    }
}

/// Mean of |n| - 1 over the texels; of two-channel normals only what x and y are too long counts, since z is rebuilt.
fn length_deviation(image: &Image) -> f32 {
    let rows = Rgba(image);
    let mut row = vec![[0.0; 4]; image.width as usize];
    let mut sum = 0.0_f64;
    for y in 0..image.height {
        rows.row(y, &mut row);
        for texel in &row {
            let [x, y, z] = [0, 1, 2].map(|c| 2.0 * texel[c] - 1.0);
            let deviation = match image.channels {
                1 | 2 => ((x * x + y * y).sqrt() - 1.0).max(0.0),
                _ => (x * x + y * y + z * z).sqrt() - 1.0,
            };
            sum += f64::from(deviation);
        }
    }
    (sum / (f64::from(image.width) * f64::from(image.height))) as f32
}
