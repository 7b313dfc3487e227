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
