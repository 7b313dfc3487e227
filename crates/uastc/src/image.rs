//! Images whose size is known to fit their texels.

use crate::BLOCK_BYTES;
use crate::lanes::Texels;
use crate::lobe::Lobe;

/// A borrowed image of RGBA8 texels, row 0 first, without padding between rows. It has at least one texel.
#[derive(Clone, Copy, Debug)]
pub struct Image<'a> {
    texels: &'a [[u8; 4]],
    /// A lobe for each texel, or none.
    lobes: &'a [Lobe],
    width: usize,
    height: usize,
}

/// Texels or blocks whose number does not fit the size of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SizeError {
    /// The slice does not have the length of an image of the given size.
    #[error(
        "expected 4 bytes for each of {width} x {height} texels and at least one texel, found {bytes} bytes; \
         pass RGBA8 texels without padding between rows"
    )]
    Texels {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// The length of the slice.
        bytes: usize,
    },
    /// The number of lobes is not that of the texels.
    #[error("expected {expected} lobes, one for each texel, found {found}; pass the lobes of the same image")]
    Lobes {
        /// How many texels the image has.
        expected: usize,
        /// How many lobes were passed.
        found: usize,
    },
    /// The number of blocks is not that of the image.
    #[error("expected {expected} blocks of 4 x 4 texels, found {found}; pass the blocks of the same image")]
    Blocks {
        /// How many blocks the texels make.
        expected: usize,
        /// How many blocks were passed.
        found: usize,
    },
    /// The four rows of a row of blocks do not have the same length, or are empty.
    #[error(
        "expected four rows of the same length above 0, found rows of {widths:?} texels; \
         repeat the last row of an image"
    )]
    Rows {
        /// Texels of each row.
        widths: [usize; 4],
    },
}

impl<'a> Image<'a> {
    /// Borrows `rgba` as an image of `width` by `height` texels of four bytes.
    ///
    /// # Errors
    /// Returns [`SizeError::Texels`] if `rgba` is empty or does not have `4 * width * height` bytes.
    pub fn new(rgba: &'a [u8], width: u32, height: u32) -> Result<Self, SizeError> {
        let (texels, rest) = rgba.as_chunks::<4>();
        let fits = rest.is_empty() && u64::from(width) * u64::from(height) == texels.len() as u64;
        if !fits || texels.is_empty() {
            return Err(SizeError::Texels { width, height, bytes: rgba.len() });
        }
        Ok(Self { texels, lobes: &[], width: width as usize, height: height as usize })
    }

    /// Adds the lobes about the normals of an image, row 0 first. [`Metric::Direction`](crate::Metric::Direction) then
    /// measures what wrong normals do to them.
    ///
    /// # Errors
    /// Returns [`SizeError::Lobes`] if the image does not have exactly as many texels.
    pub fn with_lobes(self, lobes: &'a [Lobe]) -> Result<Self, SizeError> {
        let (expected, found) = (self.texels.len(), lobes.len());
        if expected == found { Ok(Self { lobes, ..self }) } else { Err(SizeError::Lobes { expected, found }) }
    }

    /// Returns whether the texels have lobes.
    pub(crate) fn has_lobes(&self) -> bool {
        !self.lobes.is_empty()
    }

    /// Returns row `y` of the lobes; rows beyond the image repeat the last one.
    pub(crate) fn lobes(&self, y: usize) -> &'a [Lobe] {
        let at = y.min(self.height - 1) * self.width;
        &self.lobes[at..at + self.width]
    }

    /// Returns the number of blocks in a row.
    pub(crate) fn columns(&self) -> usize {
        self.width.div_ceil(4)
    }

    /// Returns the number of rows of blocks.
    pub(crate) fn rows(&self) -> usize {
        self.height.div_ceil(4)
    }

    /// Checks that the number of `blocks` is that of the image.
    pub(crate) fn check(&self, blocks: &[[u8; BLOCK_BYTES]]) -> Result<(), SizeError> {
        let (expected, found) = (self.columns() * self.rows(), blocks.len());
        if expected == found { Ok(()) } else { Err(SizeError::Blocks { expected, found }) }
    }

    /// Returns row `y` of texels; rows beyond the image repeat the last one.
    pub(crate) fn line(&self, y: usize) -> &'a [[u8; 4]] {
        let at = y.min(self.height - 1) * self.width;
        &self.texels[at..at + self.width]
    }

    /// Returns the texels of the block at `index`; texels beyond the image repeat the last column and row.
    pub(crate) fn block(&self, index: usize) -> Texels {
        let (left, top) = (index % self.columns() * 4, index / self.columns() * 4);
        std::array::from_fn(|i| {
            let (x, y) = ((left + i % 4).min(self.width - 1), (top + i / 4).min(self.height - 1));
            self.texels[y * self.width + x]
        })
    }

    /// Returns whether texel `i` of the block at `index` lies inside the image.
    pub(crate) fn contains(&self, index: usize, i: usize) -> bool {
        index % self.columns() * 4 + i % 4 < self.width && index / self.columns() * 4 + i / 4 < self.height
    }
}
