//! Rows of texels that a source computes or holds.

use crate::mip::merge::Merge;

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

    /// Writes rows `first` and below to `out`, which has a multiple of `width` texels. Rows that are computed from
    /// their neighbours are faster together.
    fn rows(&self, first: u32, out: &mut [Self::Texel]) {
        let rows = out.chunks_exact_mut(self.width() as usize);
        (first..).zip(rows).for_each(|(y, row)| self.row(y, row));
    }
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

    fn rows(&self, first: u32, out: &mut [R::Texel]) {
        (**self).rows(first, out);
    }
}
