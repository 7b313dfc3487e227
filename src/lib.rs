//! Roughcast bakes the roughness that mipmapped normal maps lose into textures.
//!
//! Data flows one way: source images ([`decode`]) -> [`bump`] (offsets) -> [`mip`] (mean and covariance per level) -> [`lobe`] (what
//! shaders make of it) -> [`select`] (the smallest model) -> [`material`] (rows of texture values) -> [`codec`] and [`ktx2`] -> [`bake`].
//! docs/architecture.md has the layers.
//!
//! The theory is A. Schilling, "Antialiasing of Bump-Maps", WSI-97-15, 1997: "the paper" throughout. Where the code
//! departs from the paper, a test named `erratum_*` shows why.

pub mod bake;
pub mod bump;
pub mod cache;
pub mod check;
pub mod cli;
pub mod codec;
pub mod compare;
pub mod decode;
mod digest;
mod foreign;
pub mod gltf;
pub mod image;
mod input_file;
pub mod inspect;
pub mod ktx2;
pub mod lobe;
pub mod material;
pub mod math;
pub mod memory;
pub mod metric;
pub mod mip;
pub mod output;
pub mod project;
pub mod remote;
pub mod render;
pub mod report;
pub mod run;
pub mod select;
pub mod settings;
mod text;
pub mod watch;

// Kernels import `crate::simd`.
use texel_simd as simd;
