//! How wrong a lobe is: the share of reflected half-vectors that it puts in the wrong place.
//!
//! The truth of a texel is the mixture of the lobes of all level-0 texels under it ([`Footprint`]). A [`Reference`]
//! samples it once; every candidate is then judged by [`Reference::error`]: what an engine decodes ([`Decoded`]), what
//! other tools make of the same normals ([`Peer`]), and the best that any single lobe can do ([`oracle`]). This module
//! takes maps and decoded images, never files.

mod clump;
mod footprint;
mod lobe;
mod oracle;
mod peaks;
mod peers;
mod reference;
mod refine;
mod score;
mod survey;
#[cfg(test)]
mod survey_tests;
#[cfg(test)]
mod tests;

pub use clump::clumped;
pub(crate) use footprint::overlaps;
pub use footprint::{Footprint, FootprintMoments, Part, Surface};
pub use lobe::Lobe;
pub use oracle::oracle;
pub use peaks::is_two_peaked;
pub use peers::Peer;
pub use reference::{Reference, SAMPLES};
pub use refine::refine;
pub use score::{Decoded, mean_errors, sample_texels, shown_lobe, shown_normal, with_z};
pub use survey::{Level0Row, Precision, Site, survey};
