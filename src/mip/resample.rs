//! Level 0 at another size: block formats demand multiples of 4, and two maps of one material need one grid.

use crate::mip::merge::Merge;
use crate::mip::{Rows, Wrap};

/// Resampling by area: each new texel merges the old texels under it, weighted by overlap. It conserves the moments
/// of the whole map exactly: what the mean loses where a new texel straddles old ones, the covariance gains.
#[derive(Clone, Copy)]
pub struct Area<R> {
    source: R,
    width: u32,
    height: u32,
}

impl<R: Rows> Area<R> {
    /// `source` on a grid of `width` x `height` texels. The same size returns the same texels.
    pub fn new(source: R, width: u32, height: u32) -> Self {
        Self { source, width, height }
    }

    /// The source where the grid is its own: texels come back as they are.
    pub fn unchanged(&self) -> Option<&R> {
        ((self.width, self.height) == (self.source.width(), self.source.height())).then_some(&self.source)
    }
}

impl<R: Rows> Rows for Area<R> {
    type Texel = R::Texel;

    fn width(&self) -> u32 {
        self.width
    }

    fn height(&self) -> u32 {
        self.height
    }

    fn row(&self, y: u32, out: &mut [R::Texel]) {
        if let Some(source) = self.unchanged() {
            return source.row(y, out);
        }
        let fine_width = self.source.width() as usize;
        let down = overlaps(self.source.height(), self.height, y);
        let mut rows = vec![R::Texel::default(); fine_width * down.len()];
        for (&(source_y, _), row) in down.iter().zip(rows.chunks_exact_mut(fine_width)) {
            self.source.row(source_y, row);
        }
        let (mut weights, mut parts) = (Vec::new(), Vec::new());
        for (x, texel) in out.iter_mut().enumerate() {
            weights.clear();
            parts.clear();
            let across = overlaps(self.source.width(), self.width, x as u32);
            for (&(_, weight_y), row) in down.iter().zip(rows.chunks_exact(fine_width)) {
                for &(source_x, weight_x) in &across {
                    weights.push(weight_x * weight_y);
                    parts.push(row[source_x as usize]);
                }
            }
            *texel = R::Texel::merge(&weights, &parts);
        }
    }
}

/// Old texels under new texel `i` along one axis and the share of the new texel that each covers.
fn overlaps(old: u32, new: u32, i: u32) -> Vec<(u32, f32)> {
    // In units of 1/(old * new) of the axis every border is an integer, so the shares are exact fractions.
    let (old, new, i) = (u64::from(old), u64::from(new), u64::from(i));
    let (start, end) = (i * old, (i + 1) * old);
    (start / new..end.div_ceil(new))
        .map(|texel| {
            let overlap = end.min((texel + 1) * new) - start.max(texel * new);
            (texel as u32, overlap as f32 / old as f32)
        })
        .collect()
}

/// Resampling to a finer grid as a sampler magnifies: linear between texel centres, across the border as it wraps.
/// For maps whose own variance no one needs (roughness, metallic, occlusion).
#[derive(Clone, Copy)]
pub struct Linear<R> {
    source: R,
    width: u32,
    height: u32,
    wrap: [Wrap; 2],
}

impl<R: Rows> Linear<R> {
    /// `source` on a grid of `width` x `height` texels; `wrap` is the sampler's mode across and down.
    pub fn new(source: R, width: u32, height: u32, wrap: [Wrap; 2]) -> Self {
        Self { source, width, height, wrap }
    }

    /// What is resampled.
    pub fn source(&self) -> &R {
        &self.source
    }

    /// As [`Area::unchanged`].
    pub fn unchanged(&self) -> Option<&R> {
        ((self.width, self.height) == (self.source.width(), self.source.height())).then_some(&self.source)
    }
}

impl<R: Rows> Rows for Linear<R> {
    type Texel = R::Texel;

    fn width(&self) -> u32 {
        self.width
    }

    fn height(&self) -> u32 {
        self.height
    }

    fn row(&self, y: u32, out: &mut [R::Texel]) {
        if let Some(source) = self.unchanged() {
            return source.row(y, out);
        }
        let fine_width = self.source.width() as usize;
        let down = neighbours(self.source.height(), self.height, y, self.wrap[1]);
        let mut rows = vec![R::Texel::default(); fine_width * 2];
        let (upper, lower) = rows.split_at_mut(fine_width);
        self.source.row(down[0].0, upper);
        self.source.row(down[1].0, lower);
        for (x, texel) in out.iter_mut().enumerate() {
            let [left, right] = neighbours(self.source.width(), self.width, x as u32, self.wrap[0]);
            let weights = [down[0].1 * left.1, down[0].1 * right.1, down[1].1 * left.1, down[1].1 * right.1];
            let (l, r) = (left.0 as usize, right.0 as usize);
            *texel = R::Texel::merge(&weights, &[upper[l], upper[r], lower[l], lower[r]]);
        }
    }
}

/// The two old texels around the centre of new texel `i` and their weights.
pub(crate) fn neighbours(old: u32, new: u32, i: u32, wrap: Wrap) -> [(u32, f32); 2] {
    // Centre (i + 1/2) * old/new - 1/2 in old texels; doubled to stay in integers: numerator / (2 new).
    let doubled = (2 * i64::from(i) + 1) * i64::from(old) - i64::from(new);
    let unit = 2 * i64::from(new);
    let fraction = doubled.rem_euclid(unit) as f32 / unit as f32;
    let below = doubled.div_euclid(unit);
    let texel = |i: i64| match wrap {
        Wrap::Repeat => i.rem_euclid(i64::from(old)) as u32,
        // One texel beyond the border, a mirrored map repeats it too.
        Wrap::Mirror | Wrap::Clamp => i.clamp(0, i64::from(old) - 1) as u32,
    };
    [(texel(below), 1.0 - fraction), (texel(below + 1), fraction)]
}
