//! Products of a bake, one file each: the material's own lobe and how bumps roughen it, normals, offsets and factors, and the mip chains
//! that hold them. This module knows neither documents nor files.

mod base;
mod bump_map;
mod bumps;
mod lobes;
mod mip_chain;
mod normals;
pub(crate) mod notes;
mod pyramids;
mod roughening;

pub use base::{Base, BaseAnisotropy, BaseLevels, BaseRows};
pub use bump_map::{BumpMap, Framed, Reading};
pub use bumps::Bumps;
pub use lobes::base_lobe;
pub(crate) use mip_chain::EDGE;
pub use mip_chain::{Encoding, GridError, LevelRow, MipChain, encode_mip_chain, grid, kept_bytes};
pub use normals::Normals;
pub use pyramids::{Quantity, Range, Ranged, bake_quantity, filter_loss, quantity_rows, range_of};
pub use roughening::Roughening;
