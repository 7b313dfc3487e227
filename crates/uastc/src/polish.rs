//! Refines the endpoints of fitted blocks of colours one by one.
//!
//! Regression finds the best endpoints before quantisation. The best quantised endpoints lie close to them.

use fearless_simd::{Simd, SimdBase, prelude::*};

use crate::blocks::Blocks;
use crate::candidate::{channel_at, other_channels, splat, split_channels};
use crate::lanes::{Grid, look_up};
use crate::line::{Line, Points};
use texel_simd::Wide;

impl<S: Simd> Blocks<S> {
    /// Refines the endpoints of blocks of one mode and selector, which store `N` channels. `M` is one less than `N`.
    /// Blocks of grey and alpha are left out, because they were refined when they were fitted.
    #[inline(always)]
    pub(crate) fn polish<const N: usize, const M: usize>(
        &mut self,
        simd: S,
        texels: &[Grid<S>; N],
        scale: &[f32; N],
        passes: usize,
    ) {
        if self.modes[0].channels == 2 {
            return;
        }
        simd.vectorize(
            #[inline(always)]
            || {
                let scale = splat(simd, scale);
                let (mode, selector) = (self.modes[0], self.selector);
                let ends = self.endpoints;
                let (range, ramp) = (mode.range, mode.ramp());
                *self = Self { modes: self.modes, pattern: self.pattern, selector, ..Self::empty(simd, mode) };
                if mode.planes == 2 {
                    let (single, others) = split_channels::<_, N, M>(texels, selector);
                    let [low, high]: [[_; N]; 2] = ends_of(&ends[0]);
                    let points =
                        Points { texels: &single, subset: None, scale: [channel_at(selector, &scale)], range, ramp };
                    let single =
                        points.line_between(simd, [channel_at(selector, &low)], [channel_at(selector, &high)]).0;
                    let single = points.polish(simd, single, passes);
                    let points =
                        Points { texels: &others, subset: None, scale: other_channels(selector, &scale), range, ramp };
                    let others =
                        points.line_between(simd, other_channels(selector, &low), other_channels(selector, &high)).0;
                    let others = points.polish(simd, others, passes);
                    self.set_planes::<N, M>(&single, &others);
                } else {
                    let masks = self.masks(simd);
                    for subset in 0..mode.subsets {
                        let mask = masks.as_ref().map(|masks| &masks[subset]);
                        let points = Points { texels, subset: mask, scale, range, ramp };
                        let [low, high] = ends_of(&ends[subset]);
                        let line = points.line_between(simd, low, high).0;
                        let line = points.polish(simd, line, passes);
                        self.set_line(&line, subset, mask);
                    }
                }
            },
        );
    }
}

/// Returns the low and the high ends of the first `N` channels.
#[inline(always)]
fn ends_of<S: Simd, const N: usize>(ends: &[[Wide<S>; 2]; 4]) -> [[Wide<S>; N]; 2] {
    let mut all = [[ends[0][0]; N], [ends[0][1]; N]];
    for c in 1..N {
        all[0][c] = ends[c][0];
        all[1][c] = ends[c][1];
    }
    all
}

impl<S: Simd, const N: usize> Points<'_, S, N> {
    /// Moves single endpoints of a fitted line to neighbouring levels while the error falls, at most `passes` times
    /// each.
    #[inline(always)]
    pub fn polish(&self, simd: S, mut best: Line<S, N>, passes: usize) -> Line<S, N> {
        for _ in 0..passes {
            let mut is_better = false;
            for k in 0..4 * N {
                let (mut low, mut high) = (best.low, best.high);
                let end = if k % 2 == 0 { &mut low[k / 4] } else { &mut high[k / 4] };
                *end = look_up(simd, &self.range.neighbour[usize::from(k % 4 < 2)], *end);
                let (line, _) = self.line_between(simd, low, high);
                let mask = line.error.simd_lt(best.error);
                if mask.any_true() {
                    best.set_where(&line, mask);
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
