//! What crate `roughcast` does with files: output folders, projects, caches, checks, pictures, jobs, remote servers and
//! watching.
//!
//! Use crate `roughcast`. The modules here are public only for its command line and for tests and benches of its
//! repository, and semantic versioning does not cover them. docs/architecture.md describes their layers.

pub mod cache;
pub mod check;
pub mod compare;
pub mod input_file;
pub mod inspect;
pub mod output;
pub mod pictures;
pub mod project;
pub mod readback;
pub mod remote;
pub mod render;
pub mod run;
pub mod standalone;
pub mod text;
pub mod viewer;
pub mod watch;

// Modules of the core are named `crate::` here as they are there.
use roughcast_core::{
    api, bake, bump, codec, decode, digest, gltf, image, ktx2, lobe, material, math, memory, metric, mip, note, report,
    settings,
};
use texel_simd as simd;
