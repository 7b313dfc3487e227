//! Checks of decoded levels: values are finite, and normals have unit length.

use super::findings::{Code, Findings};
use super::storage::Storage;
use crate::image::Samples;
use crate::ktx2::{Ktx2, ReadError};

/// Decodes every level and checks its texels.
pub fn check_decoded_levels(file: &Ktx2<'_>, are_normals: bool, findings: &mut Findings) {
    for level in 0..file.level_count() {
        // `check_levels` has reported this level already.
        if matches!(file.check_length(level), Err(ReadError::LevelLength { .. })) {
            continue;
        }
        let place = format!("level {level}");
        let storage = match Storage::decode(file, level) {
            Ok(storage) => storage,
            Err(ReadError::LevelLength { expected, found, .. }) => {
                let message = format!("expected {expected} bytes, found {found}; bake again");
                findings.add(Code::LevelLength, place, message);
                continue;
            }
            Err(error) => {
                let message = format!("expected a level that decodes, found: {error}; bake again");
                findings.add(Code::UndecodableLevel, place, message);
                continue;
            }
        };
        if let Samples::F32(values) = &storage.image().samples {
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
        if !are_normals {
            continue;
        }
        let Lengths { deviation, limit } = lengths(&storage);
        if deviation.abs() > limit {
            let message = format!(
                "expected unit normals, found lengths that are off by {deviation:+.4} on average: storage explains \
                 {limit:.4}; engines that rebuild z and those that do not would disagree; bake again"
            );
            findings.add(Code::NormalLength, place, message);
        }
    }
}

/// The lengths of the normals of a level.
struct Lengths {
    /// Mean of |n| - 1. For two-channel normals only lengths of (x, y) above 1 count, since z is rebuilt.
    deviation: f64,
    /// Largest deviation that storage explains.
    limit: f64,
}

/// Measures the normals of a level.
///
/// The limit is the mean over all blocks of the largest deviation that the format can give unit vectors. Components are
/// 2 texel - 1, so that the rounding of x, y and z together makes a vector longer or shorter by at most twice the
/// length of the vector of roundings. Texels on a line between two unit vectors are too short: the middle of a chord of
/// length c lies 1 - sqrt(1 - c^2 / 4) below the sphere. An encoder that balances this error moves the ends of the
/// chord above the sphere by as much. No chord of a block is longer than the diagonal of the box of its texels. If x
/// and y have separate weights, each of them has its residual as error instead.
fn lengths(storage: &Storage) -> Lengths {
    let (mut sum, mut most, mut count) = (0.0, 0.0, 0.0);
    let mut add = |lengths: &mut dyn Iterator<Item = f64>, bound: f64| {
        for deviation in lengths {
            (sum, most, count) = (sum + deviation, most + bound, count + 1.0);
        }
    };
    if storage.image().channels <= 2 {
        storage.visit::<2>(|texels, rounding| {
            let bound = 2.0 * (norm(rounding) + storage.residual(extents(texels)));
            add(&mut texels.iter().map(|texel| (norm(texel.map(|t| 2.0 * t - 1.0)) - 1.0).max(0.0)), bound);
        });
    } else {
        storage.visit::<3>(|texels, rounding| {
            let chord = if storage.has_shared_weights() { norm(extents(texels)).min(1.0) } else { 0.0 };
            // Components are 2 texel - 1, so a chord between vectors is twice as long as one between texels.
            let sagitta = 1.0 - (1.0 - chord * chord).sqrt();
            let bound = 2.0 * norm(rounding) + sagitta;
            add(&mut texels.iter().map(|texel| norm(texel.map(|t| 2.0 * t - 1.0)) - 1.0), bound);
        });
    }
    Lengths { deviation: sum / count, limit: most / count }
}

/// Returns the difference between the largest and the smallest value of each channel of a block.
pub fn extents<const N: usize>(texels: &[[f64; N]]) -> [f64; N] {
    std::array::from_fn(|c| {
        let values = || texels.iter().map(|texel| texel[c]);
        values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
    })
}

/// Returns the length of a vector.
pub fn norm<const N: usize>(vector: [f64; N]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}
