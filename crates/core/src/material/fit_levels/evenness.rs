//! How far merged lobes can be from the best lobes, judged from the finer texels.

use crate::lobe::{LobeTexel, OrientedLobe};
use crate::math::vector::dot;

/// How far the merged lobe of a texel can be from its best lobe.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Evenness {
    /// Hardly at all.
    #[default]
    Even,
    /// It may have the wrong width: finer texels have nearly one direction and different alphas.
    UnequalWidths,
    /// It may be far from it: alphas and directions of finer texels differ.
    Uneven,
}

/// Ratio of the alphas of finer texels from which they are uneven, if a normal is further from that of the narrowest
/// lobe than half the alpha of this lobe.
const UNEVEN: f32 = 1.8;
/// Ratio of the alphas of finer texels from which they have unequal widths, if all normals are nearer than that.
const UNEQUAL: f32 = 1.6;

/// Writes the [`Evenness`] of each texel of row `y` of a level to `marks`. `finer` writes adjacent rows of the finer
/// level, which has `size` texels and the marks `finer_marks`.
pub fn mark_row<T: LobeTexel>(
    finer: &dyn Fn(u32, &mut [T]),
    size: (u32, u32),
    finer_marks: &[Evenness],
    y: u32,
    marks: &mut [Evenness],
) {
    let rows = [2 * y, (2 * y + 1).min(size.1 - 1)];
    let mut texels = vec![T::default(); size.0 as usize * (1 + (rows[1] - rows[0]) as usize)];
    finer(rows[0], &mut texels);
    for (x, mark) in (0..).zip(marks) {
        let columns = [2 * x, (2 * x + 1).min(size.0 - 1)];
        let places = [0, 1, 2, 3].map(|i| (columns[i % 2], rows[i / 2]));
        let lobe = |(x, y): (u32, u32)| *texels[((y - rows[0]) * size.0 + x) as usize].lobe();
        let finer_mark = |(x, y): (u32, u32)| finer_marks.get((y * size.0 + x) as usize).copied();
        *mark = evenness(&places.map(lobe), places.into_iter().filter_map(finer_mark).max().unwrap_or_default());
    }
}

/// Returns the evenness of a texel with the finer texels `lobes`, of which the most uneven one is `finer`.
fn evenness(lobes: &[OrientedLobe; 4], finer: Evenness) -> Evenness {
    // The determinant of squared alphas is the fourth power of alpha. The least alpha is 0.001.
    let widths = lobes.map(|lobe| lobe.squared_alpha.0.determinant().max(1e-12));
    let narrowest = (0..4).fold(0, |least, i| if widths[i] < widths[least] { i } else { least });
    let least = widths[narrowest];
    let ratio = widths.into_iter().fold(0.0, f32::max) / least;
    let is_apart = |lobe: &OrientedLobe| {
        let between = [0, 1, 2].map(|i| lobe.normal[i] - lobes[narrowest].normal[i]);
        dot(between, between) > 0.25 * least.sqrt()
    };
    let is_apart = lobes.iter().any(is_apart);
    if finer == Evenness::Uneven || (is_apart && ratio > UNEVEN.powi(4)) {
        Evenness::Uneven
    } else if !is_apart && (ratio > UNEQUAL.powi(4) || finer == Evenness::UnequalWidths) {
        Evenness::UnequalWidths
    } else {
        Evenness::Even
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lobe::test_lobes::isotropic_lobe;

    /// The distance of normals counts in alphas of the narrowest lobe: half of it is 0.05.
    #[test]
    fn directions_decide_whether_a_width_is_enough() {
        let evenness_with = |ratio: f32, distance: f32, finer: Evenness| {
            let narrow = isotropic_lobe(0.1, 0.0);
            evenness(&[narrow, narrow, isotropic_lobe(0.1 * ratio, distance), narrow], finer)
        };
        use Evenness::{Even, UnequalWidths, Uneven};
        assert_eq!([1.5, 1.7, 9.0].map(|ratio| evenness_with(ratio, 0.04, Even)), [Even, UnequalWidths, UnequalWidths]);
        assert_eq!([1.5, 1.7, 1.9].map(|ratio| evenness_with(ratio, 0.06, Even)), [Even, Even, Uneven]);
        // Unequal widths are lost where directions differ, and uneven texels stay uneven.
        assert_eq!([0.04, 0.06].map(|distance| evenness_with(1.0, distance, UnequalWidths)), [UnequalWidths, Even]);
        assert_eq!([0.04, 0.06].map(|distance| evenness_with(1.0, distance, Uneven)), [Uneven, Uneven]);
    }
}
