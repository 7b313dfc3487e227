//! The products of a bake: normals, roughness, anisotropy, offsets with D or lambda_1, and plain textures, one file
//! each. Beside them stand the base lobe, its roughening by bumps, and the mip chains that hold encoded products. This
//! module knows neither documents nor files.

mod anisotropy;
mod base;
mod base_roughness;
mod bump_map;
mod bumps;
mod correction;
mod coverage;
mod diagnostics;
mod diffuse_light;
mod filter_loss;
mod fit_levels;
mod lobes;
mod lossy_format;
mod magnified;
mod magnified_bumps;
mod metalness;
mod mip_chain;
mod normals;
pub mod notes;
mod offset_texture;
mod plain_texture;
mod product;
mod pyramid_levels;
mod quantity;
mod range;
mod reflectance;
mod roughening;
mod roughness;
#[cfg(test)]
mod rust_and_steel;
mod stored_slopes;

pub use anisotropy::AnisotropyTexture;
pub use base::{Base, BaseAnisotropy, BaseLevels, BaseRows, base_lobe};
pub use base_roughness::BaseRoughnessTexture;
pub use bump_map::{BumpMap, FrameTransforms, Framed};
pub use bumps::Bumps;
pub use diffuse_light::{DiffuseLight, DiffuseSource};
pub use filter_loss::filter_loss;
pub(crate) use mip_chain::{EDGE, THOROUGH_LEVEL};
pub use mip_chain::{
    Encoding, GridError, LevelRow, LevelRows, LobeRow, MipChain, encode_mip_chain, first_within, grid, kept_bytes,
};
pub use normals::Normals;
pub use offset_texture::{OffsetTexture, slopes_of_texel};
pub use plain_texture::PlainTexture;
pub use product::{Product, with_rows};
pub use pyramid_levels::{
    LobeLevels, PyramidLevels, Rotated, correction_factor, lost_variance, lost_variance_of_lobes,
};
pub use quantity::{Quantity, QuantityTexture};
pub use range::Range;
pub use reflectance::{Factored, Metalness, ReflectanceRows, ReflectanceSource};
pub use roughening::Roughening;
pub use roughness::RoughnessTexture;
pub use stored_slopes::{byte_scale, normal_scale};
