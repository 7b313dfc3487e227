//! Checks of baked files: findings as data, from readers that other projects wrote.
//!
//! Containers and descriptors are read with crate `ktx2`, payloads with `basisu` and `bcdec_rs`, documents with crate
//! `gltf`. This module reads files through [`Files`] only and knows no kernels.

mod basisu;
mod checker;
mod container;
mod decoded_levels;
mod descriptor;
mod document;
mod files;
mod findings;
mod folder;
mod formats;
mod materials;
mod origin;
mod partial_file;
mod provenance;
mod scope;
mod settings;
mod sources;
mod storage;
mod targets;
mod texture;
mod variance;

pub use checker::{Checked, Checker};
pub use document::{CheckedDocument, check_document};
pub use files::{Files, ReferencedFiles};
pub use findings::{Code, Finding, Findings, MAX_LISTED, Severity};
pub use folder::Folder;
pub use formats::{CHECK_FORMAT, Report, json, junit, sarif, text};
pub use origin::Origin;
pub use partial_file::PartialFile;
pub use scope::Scope;
pub use targets::{SourceAsset, Sources};
pub use texture::{Usage, check_texture};
