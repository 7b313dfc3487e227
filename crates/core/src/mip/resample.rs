//! Resamples level 0 to another size. Block formats demand multiples of 4, and two maps of one material need one grid.

use crate::mip::merge::Merge;
use crate::mip::rows::TexelRows;
use crate::mip::wrap::Wrap;

/// Texels of `source`, resampled to another size.
#[derive(Clone, Copy)]
pub struct Resampled<R, F> {
    source: R,
    width: u32,
    height: u32,
    filter: F,
}

/// Texels resampled by area: each new texel merges the old texels under it, weighted by overlap.
///
/// Resampling by area conserves the moments of the whole map exactly. Where a new texel straddles old texels, the
/// variation that its mean loses is added to its covariance.
pub type AreaResampled<R> = Resampled<R, Area>;

/// Texels magnified to a finer grid as samplers do: linear between texel centres, and wrapped at the border.
///
/// Used for maps whose variance is not needed (roughness, metallic, occlusion).
pub type LinearResampled<R> = Resampled<R, Linear>;

/// How new texels are made of old ones.
pub trait Filter: Sync {
    /// Writes row `first` of `source`, resampled to `size` (columns, rows), and the rows below to `out`.
    fn rows<R: TexelRows>(&self, source: &R, size: [u32; 2], first: u32, out: &mut [R::Texel]);
}

impl<R: TexelRows, F> Resampled<R, F> {
    /// Returns the source.
    pub fn source(&self) -> &R {
        &self.source
    }

    /// Returns the source if its size does not change.
    pub fn unchanged(&self) -> Option<&R> {
        ((self.width, self.height) == (self.source.width(), self.source.height())).then_some(&self.source)
    }
}

impl<R: TexelRows, F: Filter> TexelRows for Resampled<R, F> {
    type Texel = R::Texel;

    fn width(&self) -> u32 {
        self.width
    }

    fn height(&self) -> u32 {
        self.height
    }

    fn row(&self, y: u32, out: &mut [R::Texel]) {
        match self.unchanged() {
            Some(source) => source.row(y, out),
            None => self.rows(y, out),
        }
    }

    fn rows(&self, first: u32, out: &mut [R::Texel]) {
        match self.unchanged() {
            Some(source) => source.rows(first, out),
            None => self.filter.rows(&self.source, [self.width, self.height], first, out),
        }
    }
}

/// The filter of [`AreaResampled`].
#[derive(Clone, Copy)]
pub struct Area;

impl<R: TexelRows> AreaResampled<R> {
    /// Resamples `source` to `width` x `height` texels. If the size is that of `source`, the texels do not change.
    pub fn new(source: R, width: u32, height: u32) -> Self {
        Self { source, width, height, filter: Area }
    }
}

impl Filter for Area {
    fn rows<R: TexelRows>(&self, source: &R, [width, height]: [u32; 2], first: u32, out: &mut [R::Texel]) {
        let fine_width = source.width() as usize;
        let across: Vec<_> = (0..width).map(|x| overlaps(source.width(), width, x)).collect();
        let down: Vec<_> =
            (first..).take(out.len() / width as usize).map(|y| overlaps(source.height(), height, y)).collect();
        // Adjacent new rows share old rows, and old rows that are computed from their neighbours are faster together.
        let (top, bottom) =
            down.iter().flatten().fold((u32::MAX, 0), |(top, bottom), (y, _)| (top.min(*y), bottom.max(*y + 1)));
        let mut rows = vec![R::Texel::default(); fine_width * bottom.saturating_sub(top) as usize];
        source.rows(top, &mut rows);
        let (mut weights, mut parts) = (Vec::new(), Vec::new());
        for (down, out) in down.iter().zip(out.chunks_exact_mut(width as usize)) {
            for (across, texel) in across.iter().zip(out) {
                weights.clear();
                parts.clear();
                for &(source_y, weight_y) in down {
                    let row = &rows[(source_y - top) as usize * fine_width..][..fine_width];
                    for &(source_x, weight_x) in across {
                        weights.push(weight_x * weight_y);
                        parts.push(row[source_x as usize]);
                    }
                }
                *texel = R::Texel::merge(&weights, &parts);
            }
        }
    }
}

/// Returns the old texels under new texel `i` along one axis, and the share of the new texel that each covers.
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

/// The filter of [`LinearResampled`].
#[derive(Clone, Copy)]
pub struct Linear {
    wrap: [Wrap; 2],
}

impl<R: TexelRows> LinearResampled<R> {
    /// Magnifies `source` to `width` x `height` texels. `wrap` is the sampler's mode across and down.
    pub fn new(source: R, width: u32, height: u32, wrap: [Wrap; 2]) -> Self {
        Self { source, width, height, filter: Linear { wrap } }
    }
}

impl Filter for Linear {
    fn rows<R: TexelRows>(&self, source: &R, size: [u32; 2], first: u32, out: &mut [R::Texel]) {
        let rows = out.chunks_exact_mut(size[0] as usize);
        (first..).zip(rows).for_each(|(y, row)| self.row(source, size, y, row));
    }
}

impl Linear {
    /// Writes row `y` of `source`, resampled to `size`, to `out`.
    fn row<R: TexelRows>(&self, source: &R, [width, height]: [u32; 2], y: u32, out: &mut [R::Texel]) {
        let fine_width = source.width() as usize;
        let down = neighbours(source.height(), height, y, self.wrap[1]);
        let mut rows = vec![R::Texel::default(); fine_width * 2];
        let (upper, lower) = rows.split_at_mut(fine_width);
        source.row(down[0].0, upper);
        source.row(down[1].0, lower);
        for (x, texel) in out.iter_mut().enumerate() {
            let [left, right] = neighbours(source.width(), width, x as u32, self.wrap[0]);
            let weights = [down[0].1 * left.1, down[0].1 * right.1, down[1].1 * left.1, down[1].1 * right.1];
            let (l, r) = (left.0 as usize, right.0 as usize);
            *texel = R::Texel::merge(&weights, &[upper[l], upper[r], lower[l], lower[r]]);
        }
    }
}

/// Returns the two old texels around the centre of new texel `i`, and their weights.
pub(crate) fn neighbours(old: u32, new: u32, i: u32, wrap: Wrap) -> [(u32, f32); 2] {
    // Centre (i + 1/2) * old/new - 1/2 in old texels; doubled to stay in integers: numerator / (2 new).
    let doubled = (2 * i64::from(i) + 1) * i64::from(old) - i64::from(new);
    let unit = 2 * i64::from(new);
    let fraction = doubled.rem_euclid(unit) as f32 / unit as f32;
    let below = doubled.div_euclid(unit);
    let texel = |i: i64| match wrap {
        Wrap::Repeat => i.rem_euclid(i64::from(old)) as u32,
        // One texel beyond the border, a mirrored map equals a clamped one.
        Wrap::Mirror | Wrap::Clamp => i.clamp(0, i64::from(old) - 1) as u32,
    };
    [(texel(below), 1.0 - fraction), (texel(below + 1), fraction)]
}
