//! The bake of crate `roughcast`: mathematics, encoders, glTF editing, and the sequence of steps. Bytes in, bytes out.
//!
//! Use crate `roughcast`, whose root is the interface of the library. The modules here are public only for the other
//! crates, tests and benches of its repository, and semantic versioning does not cover them. docs/architecture.md
//! describes their layers.
//!
//! The theory is A. Schilling, "Antialiasing of Bump-Maps", WSI-97-15, 1997: "the paper" throughout. Where the code
//! departs from the paper, a test named `erratum_*` shows why.

pub mod api;
pub mod bake;
pub mod bump;
pub mod codec;
pub mod decode;
pub mod digest;
pub mod foreign;
pub mod gltf;
pub mod image;
pub mod ktx2;
pub mod lobe;
pub mod material;
pub mod math;
pub mod memory;
pub mod metric;
pub mod mip;
pub mod note;
pub mod report;
pub mod select;
pub mod settings;
#[cfg(test)]
#[path = "../../../tests/common/skip.rs"]
mod skip;

// Kernels import `crate::simd`.
use texel_simd as simd;
