//! The products of a bake: normals, roughness, anisotropy, and offsets with D or lambda_1, one file each. Beside them
//! stand the base lobe, its roughening by bumps, and the mip chains that hold encoded products. This module knows
//! neither documents nor files.

mod anisotropy;
mod base;
mod bump_map;
mod bumps;
mod correction;
mod diagnostics;
mod filter_loss;
mod lobes;
mod mip_chain;
mod normals;
pub mod notes;
mod product;
mod quantity;
mod range;
mod roughening;
mod roughness;

pub use anisotropy::AnisotropyTexture;
pub use base::{Base, BaseAnisotropy, BaseLevels, BaseRows, base_lobe};
pub use bump_map::{BumpMap, FrameTransforms, Framed};
pub use bumps::Bumps;
pub use filter_loss::filter_loss;
pub(crate) use mip_chain::EDGE;
pub use mip_chain::{Encoding, GridError, LevelRow, MipChain, encode_mip_chain, grid, kept_bytes};
pub use normals::Normals;
pub use product::Product;
pub use quantity::{Quantity, QuantityTexture};
pub use range::Range;
pub use roughening::Roughening;
pub use roughness::RoughnessTexture;
