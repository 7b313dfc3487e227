//! Roughcast bakes the roughness that mipmapped normal maps lose into textures.
//!
//! Data flows one way, room by room: source images -> [`map`] -> [`bump`] (offsets) -> [`pyramid`] (mean and
//! covariance per level) -> [`roughness`] (D, lambda_1, correction) -> [`lobe`] (what shaders make of it).
//!
//! The theory is A. Schilling, "Antialiasing of Bump-Maps", WSI-97-15, 1997: "the paper" throughout. Where the code
//! departs from the paper, a test named `erratum_*` shows why.

pub mod bake;
pub mod bump;
pub mod cache;
pub mod check;
pub mod choose;
pub mod cli;
pub mod compare;
pub mod config;
mod digest;
mod foreign;
pub mod gltf;
mod input_file;
pub mod inspect;
pub mod judge;
pub mod lobe;
pub mod map;
pub mod memory;
pub mod output;
pub mod plan;
pub mod pyramid;
pub mod remote;
pub mod render;
pub mod roughness;
pub mod symmetric;
mod text;
pub mod texture;
pub mod watch;

// Kernels import `crate::simd`.
use texel_simd as simd;
