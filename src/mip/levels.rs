//! MipTail levels: kept, or made anew whenever they are read.

use fearless_simd::Level as InstructionSet;

use crate::mip::Rows;
use crate::mip::merge::Merge;
use crate::mip::reduce::{Level, Taps, build, level_size, level_sizes, reduce_row};

/// Levels 1 and coarser of a source, which is handed in to read them.
pub struct MipTail<T> {
    /// How many levels are too large to be kept.
    passing: usize,
    kept: Vec<Level<T>>,
}

/// Texels of the largest level that is kept, level 1 of 4096 x 4096, where merging is quick. Making level 1 anew whenever it is read
/// costs time, keeping it memory.
const MOST_KEPT: u64 = 1 << 22;

impl<T: Merge> MipTail<T> {
    /// The full chain over `source`.
    pub fn new(source: &impl Rows<Texel = T>) -> Self {
        Self::keeping(source, MOST_KEPT)
    }

    /// The same, of which levels with more than `most` texels are not kept.
    pub fn keeping(source: &impl Rows<Texel = T>, most: u64) -> Self {
        let sizes = level_sizes(source.width(), source.height());
        let is_large = |&&(width, height): &&(u32, u32)| u64::from(width) * u64::from(height) > most;
        let passing = sizes.iter().skip(1).take_while(is_large).count();
        Self { passing, kept: build(&Passing { source, level: passing }) }
    }

    /// Writes row `y` of `level`, which may be 0, to `out`.
    pub fn row(&self, source: &impl Rows<Texel = T>, level: usize, y: u32, out: &mut [T]) {
        match level.checked_sub(self.passing + 1) {
            None => Passing { source, level }.row(y, out),
            Some(kept) => self.kept[kept].row(y, out),
        }
    }

    /// Calls `read` with row `y` of `level`, which may be 0: with the kept row where there is one, which need not be copied.
    pub fn with_row<O>(&self, source: &impl Rows<Texel = T>, level: usize, y: u32, read: impl FnOnce(&[T]) -> O) -> O {
        match level.checked_sub(self.passing + 1) {
            None => {
                let rows = Passing { source, level };
                let mut row = vec![T::default(); rows.width() as usize];
                rows.row(y, &mut row);
                read(&row)
            }
            Some(kept) => read(self.kept[kept].texels_of(y)),
        }
    }

    /// The single texel of the coarsest level.
    pub fn whole(&self, source: &impl Rows<Texel = T>) -> T {
        let mut texel = [T::default()];
        self.row(source, self.passing + self.kept.len(), 0, &mut texel);
        texel[0]
    }
}

impl<T> From<Vec<Level<T>>> for MipTail<T> {
    fn from(kept: Vec<Level<T>>) -> Self {
        Self { passing: 0, kept }
    }
}

/// A level whose rows are made from level 0.
struct Passing<'a, R> {
    source: &'a R,
    level: usize,
}

impl<R: Rows> Rows for Passing<'_, R> {
    type Texel = R::Texel;

    fn width(&self) -> u32 {
        (0..self.level).fold(self.source.width(), |width, _| level_size(width))
    }

    fn height(&self) -> u32 {
        (0..self.level).fold(self.source.height(), |height, _| level_size(height))
    }

    fn row(&self, y: u32, out: &mut [R::Texel]) {
        let Some(level) = self.level.checked_sub(1) else { return self.source.row(y, out) };
        let finer = Self { source: self.source, level };
        let (width, down) = (finer.width() as usize, Taps::new(finer.height(), y));
        let mut rows = vec![R::Texel::default(); width * down.count];
        for (tap, row) in rows.chunks_exact_mut(width).enumerate() {
            finer.row(down.first + tap as u32, row);
        }
        reduce_row(InstructionSet::new(), &rows, width, &down, out);
    }
}
