//! Mip levels: rows of texels, the rule that merges them, sizes, resampling and wrap modes.
//!
//! All functions work on rows of texels ([`TexelRows`]). A level is therefore never held in memory twice, and level 0
//! need not be held at all. This module does not know what a texel means.

mod levels;
mod merge;
mod reduce;
mod resample;
mod wrap;

pub use levels::MipTail;
pub(crate) use merge::MAX_PARTS;
pub use merge::{Merge, Numbers};
pub use reduce::{Level, build, level_size, level_sizes};
pub(crate) use resample::neighbours;
pub use resample::{AreaResampled, LinearResampled};
pub use wrap::Wrap;

/// A grid of texels that can be read row by row, from any thread.
pub trait TexelRows: Sync {
    /// The type of a texel.
    type Texel: Merge;

    /// Returns the number of columns.
    fn width(&self) -> u32;

    /// Returns the number of rows.
    fn height(&self) -> u32;

    /// Writes row `y` (0 is the top) to `out`, which has `width` texels.
    fn row(&self, y: u32, out: &mut [Self::Texel]);
}

impl<R: TexelRows> TexelRows for &R {
    type Texel = R::Texel;

    fn width(&self) -> u32 {
        (**self).width()
    }

    fn height(&self) -> u32 {
        (**self).height()
    }

    fn row(&self, y: u32, out: &mut [R::Texel]) {
        (**self).row(y, out);
    }
}

/// A source with its mip tail. Level 0 is read from the source whenever it is needed.
pub struct Pyramid<R: TexelRows> {
    source: R,
    tail: MipTail<R::Texel>,
}

impl<R: TexelRows> Pyramid<R> {
    /// Builds the full mip chain of `source`.
    pub fn new(source: R) -> Self {
        let tail = MipTail::new(&source);
        Self { source, tail }
    }

    /// Returns level 0.
    pub fn source(&self) -> &R {
        &self.source
    }

    /// Returns the sizes of all levels, level 0 first.
    pub fn sizes(&self) -> Vec<(u32, u32)> {
        level_sizes(self.source.width(), self.source.height())
    }

    /// Writes row `y` of `level` to `out`.
    pub fn row(&self, level: usize, y: u32, out: &mut [R::Texel]) {
        self.tail.row(&self.source, level, y, out);
    }

    /// Returns the single texel of the coarsest level.
    pub fn coarsest(&self) -> R::Texel {
        self.tail.coarsest(&self.source)
    }
}

#[cfg(test)]
mod tests;
