//! Refinement of a fitted block, endpoint by endpoint.
//!
//! Regression finds the best endpoints before they are quantised; the best quantised ones lie near
//! by. On normal maps this lowers the angular error by 4 to 7 %, at a tenth of the time.

use fearless_simd::Simd;

use super::candidate::{SUBSETS, rest};
use super::line::{Line, settle};
use super::moments::{ALL, Lane};
use super::pack::Block;
use super::tables::Range;

impl Block {
    /// Polishes the endpoints of an opaque block.
    pub(super) fn polish<S: Simd>(&mut self, simd: S, texels: &[Lane; 3], scale: &[f32; 3], passes: usize) {
        simd.vectorize(
            #[inline(always)]
            || match self.mode.weight_bits {
                2 => self.polish_lines::<2>(texels, scale, passes),
                3 => self.polish_lines::<3>(texels, scale, passes),
                4 => self.polish_lines::<4>(texels, scale, passes),
                _ => self.polish_lines::<5>(texels, scale, passes),
            },
        );
    }

    #[inline(always)]
    fn polish_lines<const BITS: u32>(&mut self, texels: &[Lane; 3], scale: &[f32; 3], passes: usize) {
        self.error = 0.0;
        if self.mode.planes == 2 {
            let alone = self.selector;
            self.polish_line::<1, BITS>((texels, scale), [alone], (0, 1), (&ALL, 0xffff), passes);
            self.polish_line::<2, BITS>((texels, scale), rest(alone), (0, 0), (&ALL, 0xffff), passes);
        } else if self.mode.subsets == 2 {
            for (subset, mask) in SUBSETS[self.pattern].iter().enumerate() {
                let members = (mask, self.members(subset));
                self.polish_line::<3, BITS>((texels, scale), [0, 1, 2], (subset, 0), members, passes);
            }
        } else {
            self.polish_line::<3, BITS>((texels, scale), [0, 1, 2], (0, 0), (&ALL, 0xffff), passes);
        }
    }

    #[inline(always)]
    fn polish_line<const N: usize, const BITS: u32>(
        &mut self,
        (texels, scale): (&[Lane; 3], &[f32; 3]),
        channels: [usize; N],
        (subset, plane): (usize, usize),
        (mask, members): (&Lane, u16),
        passes: usize,
    ) {
        let texels = channels.map(|c| texels[c]);
        let [low, high] = [0, 1].map(|end| channels.map(|c| self.endpoints[subset][c][end]));
        let line = polish::<N, BITS>(&texels, mask, [low, high], &channels.map(|c| scale[c]), self.mode.range, passes);
        self.place(&line, channels, subset, plane, members);
    }
}

/// Moves single endpoints of a fitted line to neighbouring levels as long as that helps.
#[inline(always)]
fn polish<const N: usize, const BITS: u32>(
    texels: &[Lane; N],
    subset: &Lane,
    mut ends: [[u8; N]; 2],
    scale: &[f32; N],
    range: &Range,
    passes: usize,
) -> Line<N> {
    let settled = |ends: &[[u8; N]; 2]| {
        let [low, high] = ends.map(|end| std::array::from_fn(|c| f32::from(end[c]) * scale[c]));
        settle::<N, BITS>(texels, subset, &low, &high, scale, range).0
    };
    let mut best = settled(&ends);
    for _ in 0..passes {
        let before = best.error;
        for (end, c, up) in moves::<N>() {
            let mut moved = ends;
            moved[end][c] = range.neighbour(ends[end][c], up);
            let line = settled(&moved);
            if line.error < best.error {
                (best, ends) = (line, moved);
            }
        }
        if best.error == before {
            break;
        }
    }
    best
}

/// Every endpoint, channel and direction.
fn moves<const N: usize>() -> impl Iterator<Item = (usize, usize, bool)> {
    (0..4 * N).map(|k| (k % 2, k / 4, k % 4 < 2))
}
