//! Refinement of fitted blocks of colours, endpoint by endpoint.
//!
//! Regression finds the best endpoints before they are quantised; the best quantised ones lie near by.

use fearless_simd::{Simd, SimdBase, prelude::*};

use crate::blocks::Blocks;
use crate::candidate::{alone, parted, rest, splat};
use crate::lanes::{Grid, look_up};
use crate::line::{Line, Points};
use texel_simd::Wide;

impl<S: Simd> Blocks<S> {
    /// Polishes the endpoints of opaque blocks of one mode and selector but those of grey and alpha,
    /// which are polished when they are made.
    #[inline(always)]
    pub(crate) fn polish(&mut self, simd: S, texels: &[Grid<S>; 3], scale: &[f32; 3], passes: usize) {
        match self.modes[0].weight_bits {
            _ if self.modes[0].channels == 2 => {}
            2 => self.polish_lines::<2>(simd, texels, scale, passes),
            3 => self.polish_lines::<3>(simd, texels, scale, passes),
            4 => self.polish_lines::<4>(simd, texels, scale, passes),
            _ => self.polish_lines::<5>(simd, texels, scale, passes),
        }
    }

    #[inline(always)]
    fn polish_lines<const BITS: u32>(&mut self, simd: S, texels: &[Grid<S>; 3], scale: &[f32; 3], passes: usize) {
        simd.vectorize(
            #[inline(always)]
            || {
                let scale = splat(simd, scale);
                let (mode, selector) = (self.modes[0], self.selector);
                let ends = self.endpoints;
                let range = mode.range;
                *self = Self { modes: self.modes, pattern: self.pattern, selector, ..Self::empty(simd, mode) };
                if mode.planes == 2 {
                    let (single, others) = parted::<_, 3, 2>(texels, selector);
                    let [low, high] = ends_of(&ends[0]);
                    let points = Points { texels: &single, subset: None, scale: [alone(selector, &scale)], range };
                    let single = points.chosen::<BITS>(simd, [alone(selector, &low)], [alone(selector, &high)]).0;
                    let single = points.polish::<BITS>(simd, single, passes);
                    let points = Points { texels: &others, subset: None, scale: rest(selector, &scale), range };
                    let others = points.chosen::<BITS>(simd, rest(selector, &low), rest(selector, &high)).0;
                    let others = points.polish::<BITS>(simd, others, passes);
                    self.place_planes::<3, 2>(&single, &others);
                } else {
                    let masks = self.masks(simd);
                    for subset in 0..mode.subsets {
                        let mask = masks.as_ref().map(|masks| &masks[subset]);
                        let points = Points { texels, subset: mask, scale, range };
                        let [low, high] = ends_of(&ends[subset]);
                        let line = points.chosen::<BITS>(simd, low, high).0;
                        let line = points.polish::<BITS>(simd, line, passes);
                        self.place(&line, subset, mask);
                    }
                }
            },
        );
    }
}

/// Low and high ends of the first three channels.
#[inline(always)]
fn ends_of<S: Simd>([r, g, b, _]: &[[Wide<S>; 2]; 4]) -> [[Wide<S>; 3]; 2] {
    [[r[0], g[0], b[0]], [r[1], g[1], b[1]]]
}

impl<S: Simd, const N: usize> Points<'_, S, N> {
    /// Moves single endpoints of a fitted line to neighbouring levels as long as that helps.
    #[inline(always)]
    pub fn polish<const BITS: u32>(&self, simd: S, mut best: Line<S, N>, passes: usize) -> Line<S, N> {
        for _ in 0..passes {
            let mut is_better = false;
            for k in 0..4 * N {
                let (mut low, mut high) = (best.low, best.high);
                let end = if k % 2 == 0 { &mut low[k / 4] } else { &mut high[k / 4] };
                *end = look_up(simd, &self.range.neighbour[usize::from(k % 4 < 2)], *end);
                let (line, _) = self.chosen::<BITS>(simd, low, high);
                let mask = line.error.simd_lt(best.error);
                if mask.any_true() {
                    best.take(&line, mask);
                    is_better = true;
                }
            }
            if !is_better {
                break;
            }
        }
        best
    }
}
