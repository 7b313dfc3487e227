//! Reading baked files again: findings as data, from readers that are not our writers.
//!
//! Containers and descriptors are read with crate `ktx2`, payloads with `basisu` and `bcdec_rs`, documents with crate
//! `gltf`. This module does no I/O and knows no kernels.

mod basisu;
mod container;
mod descriptor;
mod document;
mod extension;
mod files;
mod findings;
mod held;
mod materials;
mod origin;
mod provenance;
mod render;
mod scope;
mod settings;
mod sources;
mod storage;
mod texels;
mod texture;
mod variance;

pub use document::{CheckedDocument, check_document};
pub use extension::{FrameName, RoughnessModel, RoughnessPyramid, TextureInfo};
pub use files::{Files, Referred};
pub use findings::{Code, Finding, Findings, LISTED, Severity};
pub use held::Held;
pub use origin::Origin;
pub use render::{Report, json, junit, sarif, text};
pub use scope::Scope;
pub use texture::{Usage, check_texture};
