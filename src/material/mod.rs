//! Products of a bake, one file each: the material's own lobe and how bumps roughen it, normals, offsets and factors, and the mip chains
//! that hold them. This module knows neither documents nor files.

mod base;
mod bumps;
mod chain;
mod fold;
mod lobes;
mod normals;
pub(crate) mod notes;
mod pyramids;
mod relief;

pub use base::{Base, BaseAnisotropy, BaseLevels, BaseRows};
pub use bumps::Bumps;
pub(crate) use chain::EDGE;
pub use chain::{Chain, Encoding, GridError, LevelRow, encode_chain, grid, kept_bytes};
pub use fold::Fold;
pub use lobes::own_lobe;
pub use normals::Normals;
pub use pyramids::{Quantity, Range, Ranged, bake_quantity, filter_loss, quantity_rows, range_of};
pub use relief::{Framed, Reading, Relief};
