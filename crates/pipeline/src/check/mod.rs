//! Checks of baked files: findings as data, from readers that other projects wrote.
//!
//! Containers and descriptors are read with crate `ktx2`, payloads with `basisu` and `bcdec_rs`, documents with crate
//! `gltf`. This module reads files through [`Files`] only and knows no kernels.

mod basisu;
mod checked_files;
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
mod partial_file;
mod provenance;
mod pyramid_levels;
mod scope;
mod settings;
mod source_digests;
mod storage;
mod texture;
mod texture_references;

pub use checked_files::{SourceAsset, Sources};
pub use checker::{Checked, Checker};
pub use document::{CheckedDocument, check_document};
pub use files::{Files, ReferencedFiles};
pub use findings::{Code, Finding, Findings, MAX_LISTED, Severity};
pub use folder::Folder;
pub use formats::{CHECK_FORMAT, Report, json, junit, sarif, text};
pub use partial_file::PartialFile;
pub use scope::Scope;
pub use source_digests::SourceDigests;
pub use texture::{Usage, check_texture};
