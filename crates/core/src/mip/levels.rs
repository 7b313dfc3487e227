//! Mip tails: small levels are kept, and large levels are computed whenever they are read.

use rayon::prelude::*;

use crate::mip::merge::Merge;
use crate::mip::reduce::{Level, build, finer_rows_for, level_size, level_sizes, reduce_rows};
use crate::mip::rows::TexelRows;

/// Levels 1 and coarser of a source. Methods take the source, because the tail does not own it.
pub struct MipTail<T> {
    /// Number of levels that are too large to be kept: levels 1 to `unkept`.
    unkept: usize,
    kept: Vec<Level<T>>,
}

/// Texels of the largest level that is kept by default: those of level 1 of 4096 x 4096. Keeping a level costs memory,
/// and computing a level whenever it is read costs time.
const MAX_KEPT_TEXELS: u64 = 1 << 22;

impl<T: Merge> MipTail<T> {
    /// Builds the full mip tail of `source`.
    pub fn new(source: &impl TexelRows<Texel = T>) -> Self {
        Self::with_max_kept(source, MAX_KEPT_TEXELS)
    }

    /// Builds the full mip tail of `source`. Levels with more than `max_texels` texels are not kept.
    pub fn with_max_kept(source: &impl TexelRows<Texel = T>, max_texels: u64) -> Self {
        let sizes = level_sizes(source.width(), source.height());
        let is_large = |&&(width, height): &&(u32, u32)| u64::from(width) * u64::from(height) > max_texels;
        let unkept = sizes.iter().skip(1).take_while(is_large).count();
        Self { unkept, kept: build(&UnkeptLevel { source, level: unkept }) }
    }

    /// Writes row `y` of `level`, which may be 0, to `out`.
    pub fn row(&self, source: &impl TexelRows<Texel = T>, level: usize, y: u32, out: &mut [T]) {
        match level.checked_sub(self.unkept + 1) {
            None => UnkeptLevel { source, level }.row(y, out),
            Some(kept) => self.kept[kept].row(y, out),
        }
    }

    /// Calls `read` with row `y` of `level`, which may be 0. A row of a kept level is passed without a copy.
    pub fn with_row<O>(
        &self,
        source: &impl TexelRows<Texel = T>,
        level: usize,
        y: u32,
        read: impl FnOnce(&[T]) -> O,
    ) -> O {
        match level.checked_sub(self.unkept + 1) {
            None => {
                let rows = UnkeptLevel { source, level };
                let mut row = vec![T::default(); rows.width() as usize];
                rows.row(y, &mut row);
                read(&row)
            }
            Some(kept) => read(self.kept[kept].row_texels(y)),
        }
    }

    /// Calls `update(y, finer, row)` for every row of `level`, in any order. `finer` writes rows of any finer level.
    /// Levels that are not kept stay as they are.
    pub fn update_level(
        &mut self,
        source: &impl TexelRows<Texel = T>,
        level: usize,
        update: impl Fn(u32, &FinerRows<'_, T>, &mut [T]) + Sync,
    ) {
        let unkept = self.unkept;
        let Some(index) = level.checked_sub(unkept + 1) else { return };
        let (finer, coarser) = self.kept.split_at_mut(index);
        let finer_rows = |level: usize, first, out: &mut [T]| match level.checked_sub(unkept + 1) {
            Some(index) => finer[index].rows(first, out),
            None => UnkeptLevel { source, level }.rows(first, out),
        };
        let Some(Level { width, texels, .. }) = coarser.first_mut() else { return };
        let rows = texels.par_chunks_exact_mut(*width as usize).enumerate();
        rows.for_each(|(y, row)| update(y as u32, &finer_rows, row));
    }

    /// Returns the finest level that is kept.
    pub fn first_kept(&self) -> usize {
        self.unkept + 1
    }

    /// Returns the single texel of the coarsest level.
    pub fn coarsest(&self, source: &impl TexelRows<Texel = T>) -> T {
        let mut texel = [T::default()];
        self.row(source, self.unkept + self.kept.len(), 0, &mut texel);
        texel[0]
    }
}

/// Writes rows of a level to a slice that has room for them: `(level, first, out)`, where `first` is the topmost row.
pub type FinerRows<'a, T> = dyn Fn(usize, u32, &mut [T]) + Sync + 'a;

impl<T> From<Vec<Level<T>>> for MipTail<T> {
    fn from(kept: Vec<Level<T>>) -> Self {
        Self { unkept: 0, kept }
    }
}

/// A level whose rows are computed from level 0 whenever they are read.
struct UnkeptLevel<'a, R> {
    source: &'a R,
    level: usize,
}

impl<R: TexelRows> TexelRows for UnkeptLevel<'_, R> {
    type Texel = R::Texel;

    fn width(&self) -> u32 {
        (0..self.level).fold(self.source.width(), |width, _| level_size(width))
    }

    fn height(&self) -> u32 {
        (0..self.level).fold(self.source.height(), |height, _| level_size(height))
    }

    fn row(&self, y: u32, out: &mut [R::Texel]) {
        self.rows(y, out);
    }

    fn rows(&self, first: u32, out: &mut [R::Texel]) {
        match self.level.checked_sub(1) {
            None => self.source.rows(first, out),
            Some(level) => {
                let rows = out.len() / self.width() as usize;
                let finer = Self { source: self.source, level };
                reduce_rows(&finer, first, &mut finer_rows_for(&finer, rows), out);
            }
        }
    }
}
