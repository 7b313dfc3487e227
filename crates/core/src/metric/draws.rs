//! Draws level-0 texels of a footprint, stratified and at random.
//!
//! A footprint of up to [`DRAWN`] texels across is taken as a whole. In a larger footprint, one row is drawn from each
//! of [`DRAWN`] equal strata, and one column from each of as many strata of that row. Each row draws columns of its
//! own, and each stratum its own place, since bumps that repeat could hide between equally spaced texels.

use crate::metric::footprint::overlaps;

/// Strata along each axis of a footprint. A lobe that is fitted to 1024 texels of a footprint is within 1.02 x of the
/// best lobe almost everywhere; with 256 texels it is not.
pub const DRAWN: u32 = 32;

/// A texel of a level of a mip chain whose level 0 has the size `whole`.
#[derive(Clone, Copy)]
pub struct DrawnFootprint {
    /// Size of level 0.
    pub whole: (u32, u32),
    /// Size of the level.
    pub size: (u32, u32),
    /// Column and row in the level.
    pub texel: (u32, u32),
    /// Strata along each axis.
    pub strata: u32,
}

impl DrawnFootprint {
    /// Returns the rows of level 0 that are drawn, top to bottom, with their shares. All texels of a row of the level
    /// draw the same rows.
    pub fn rows(&self) -> Vec<(u32, f32)> {
        drawn(self.whole.1, self.size.1, self.texel.1, self.strata, self.size.0)
    }

    /// Returns the columns that are drawn from row `y`, equally many from each row, with their shares.
    pub fn columns(&self, y: u32) -> Vec<(u32, f32)> {
        drawn(self.whole.0, self.size.0, self.texel.0, self.strata, y)
    }
}

/// Returns the texels of an axis of length `old` that are drawn from those under texel `i` of an axis of length `new`,
/// with their shares. `seed` and `i` decide where in its stratum each texel lies.
fn drawn(old: u32, new: u32, i: u32, strata: u32, seed: u32) -> Vec<(u32, f32)> {
    let new = new.max(1);
    let covered = f64::from(old) / f64::from(new);
    if covered <= f64::from(strata) {
        return overlaps(old, new, i).into_iter().map(|(texel, share)| (texel, share as f32)).collect();
    }
    let (start, width) = (covered * f64::from(i.min(new - 1)), covered / f64::from(strata));
    let share = 1.0 / strata as f32;
    let at = |stratum: u32| {
        let place = f64::from(hash([seed, i, stratum])) / f64::from(u32::MAX);
        let texel = start + (f64::from(stratum) + place) * width;
        ((texel as u32).min(old - 1), share)
    };
    (0..strata).map(at).collect()
}

/// Returns a number that looks random: the finaliser of MurmurHash3 (A. Appleby, 2011), applied to each number in turn.
fn hash(numbers: [u32; 3]) -> u32 {
    numbers.into_iter().fold(0x9e37_79b9, |state, number| {
        let mut mixed = (state ^ number).wrapping_add(0x9e37_79b9);
        mixed = (mixed ^ (mixed >> 16)).wrapping_mul(0x85eb_ca6b);
        mixed = (mixed ^ (mixed >> 13)).wrapping_mul(0xc2b2_ae35);
        mixed ^ (mixed >> 16)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Texels of a footprint are drawn from every stratum, in order, and their shares sum to 1.
    #[test]
    fn draws_one_texel_from_each_stratum() {
        for (old, new) in [(4096, 64), (4096, 1), (1000, 7), (745, 5), (33, 1)] {
            for i in 0..new {
                let drawn = drawn(old, new, i, DRAWN, 5);
                assert!(drawn.windows(2).all(|pair| pair[0].0 <= pair[1].0));
                let total: f32 = drawn.iter().map(|d| d.1).sum();
                assert!((total - 1.0).abs() < 1e-5, "{total}");
                let (start, end) =
                    (u64::from(i) * u64::from(old) / u64::from(new), (u64::from(i) + 1) * u64::from(old));
                let inside = |x: u32| u64::from(x) >= start && u64::from(x) * u64::from(new) < end;
                assert!(drawn.iter().all(|d| inside(d.0)), "{old} {new} {i}");
            }
        }
    }

    /// Stripes of every period of 2 to 40 texels are met in proportion to their width.
    #[test]
    fn meets_stripes_in_proportion_to_their_width() {
        for period in 2..40 {
            let footprint = DrawnFootprint { whole: (4096, 4096), size: (4, 4), texel: (1, 2), strata: DRAWN };
            let columns = footprint.rows().into_iter().flat_map(|(y, _)| footprint.columns(y));
            let dark: f32 = columns.filter(|(x, _)| x % period == 0).map(|(_, share)| share).sum();
            let (share, wanted) = (dark / DRAWN as f32, 1.0 / period as f32);
            // Four standard deviations of 1024 independent draws.
            let deviation = (wanted * (1.0 - wanted) / 1024.0).sqrt();
            assert!((share - wanted).abs() < 4.0 * deviation, "period {period}: {share}");
        }
    }
}
