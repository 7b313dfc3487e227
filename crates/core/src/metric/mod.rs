//! The lobe error: the share of reflected half-vectors that a lobe puts in the wrong place.
//!
//! The reference of a texel is the mixture of the lobes of all level-0 texels that it covers ([`Footprint`]). A
//! [`Reference`] samples this mixture once, and [`Reference::error`] compares every candidate with it: what an engine
//! decodes ([`Decoded`]), what other tools make of the same normals ([`Peer`]), and the best single lobe ([`oracle`]).
//! This module takes maps and decoded images, never files.

mod decoded;
mod density;
mod draws;
mod fit;
mod fit_width;
mod footprint;
mod magnified;
mod mixture;
mod oracle;
mod peaks;
mod peers;
mod reference;
mod sample_sites;
#[cfg(test)]
mod tests;

pub use decoded::{Decoded, mean_errors, sample_texels, shown_lobe, shown_normal, with_z};
pub use density::{Lobe, MIN_ALPHA};
pub use draws::{DRAWN, DrawnFootprint};
pub use fit::{FitEffort, Search, fit};
pub use fit_width::fit_width;
pub use footprint::{Footprint, FootprintMoments, Part, Surface, base_of_roughness, roughness_of_base};
pub use oracle::oracle;
pub use peaks::is_two_peaked;
pub use peers::Peer;
pub use reference::{Reference, SAMPLES};
pub use sample_sites::{Level0Rows, Precision, Site, sample_bytes, sample_sites};
