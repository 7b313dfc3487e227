//! The files that a bake of a document reads and writes, as far as they are known before any image is decoded.

use std::path::PathBuf;

use serde_json::Value;

use super::error::BakeError;
use super::output_document;
use crate::gltf::document::{Container, Document, check_version};
use crate::gltf::json::Json;
use crate::gltf::material::materials;
use crate::gltf::plain_textures::plain_textures;
use crate::settings::{Profile, Textures};

/// The facts of a document that are known before its bake.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedFiles {
    /// Files that images and buffers name, relative to the document.
    pub files: Vec<PathBuf>,
    /// Files that buffers name. The output names them, too, unless it is a .glb.
    pub buffers: Vec<PathBuf>,
    /// Whether a material has bumps.
    pub has_bumps: bool,
    /// Whether a material has bumps that the pyramid profile describes.
    pub has_pyramid_bumps: bool,
    /// Whether a material has a texture that only [`Textures::All`] writes.
    pub has_plain_textures: bool,
    /// The container of the document.
    pub container: Container,
    /// Whether a buffer of the document is the BIN chunk of a .glb, which becomes a file beside a .gltf.
    pub has_bin: bool,
}

impl PlannedFiles {
    /// Returns whether a bake may write textures. A document without new textures is returned unchanged if it keeps its
    /// container.
    pub fn may_write_textures(&self, profile: Profile, textures: Textures) -> bool {
        let has_bumps = if profile.is_portable() { self.has_bumps } else { self.has_pyramid_bumps };
        has_bumps || textures == Textures::All && self.has_plain_textures
    }
}

/// Returns the facts of `document`.
///
/// # Errors
/// [`BakeError`] for materials and references that a bake would refuse, too.
pub fn planned_files(document: &Document) -> Result<PlannedFiles, BakeError> {
    let json: &Json = document.json();
    let root: Value = json.value("")?.unwrap_or_default();
    check_version(&root)?;
    let materials = materials(&root).into_iter().collect::<Result<Vec<_>, _>>()?;
    let layers = || materials.iter().flat_map(|material| &material.layers);
    Ok(PlannedFiles {
        files: output_document::files(json)?,
        buffers: output_document::buffer_files(json)?,
        has_bumps: layers().next().is_some(),
        has_pyramid_bumps: layers().any(|layer| layer.kind.row().is_in_pyramid),
        has_plain_textures: !plain_textures(&root).is_empty(),
        container: document.container(),
        has_bin: document.buffer_0().is_some(),
    })
}
