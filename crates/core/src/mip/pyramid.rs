//! A source with all of its mip levels.

use crate::mip::levels::MipTail;
use crate::mip::reduce::level_sizes;
use crate::mip::rows::TexelRows;

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
