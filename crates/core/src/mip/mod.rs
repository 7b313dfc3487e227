//! Mip levels: rows of texels, the rule that merges them, sizes, resampling and wrap modes.
//!
//! All functions work on rows of texels ([`TexelRows`]). A level is therefore never held in memory twice, and level 0
//! need not be held at all. This module does not know what a texel means.

mod levels;
mod merge;
mod pyramid;
mod reduce;
mod resample;
mod rows;
#[cfg(test)]
mod tests;
mod wrap;

pub use levels::{FinerRows, MipTail};
pub(crate) use merge::MAX_PARTS;
pub use merge::{Merge, Numbers};
pub use pyramid::Pyramid;
pub use reduce::{Level, build, level_size, level_sizes};
pub(crate) use resample::neighbours;
pub use resample::{AreaResampled, LinearResampled};
pub use rows::TexelRows;
pub use wrap::{Magnification, Sampler, Wrap};
