//! Our bakes, which are compared with the peers.

use crate::render::{Bumps, Material, Texture};

/// A bake of ours.
pub struct Ours {
    /// Name in the chart.
    pub name: String,
    /// The material as an engine reads it.
    pub material: Material,
    /// Bytes of the files that the bake wrote.
    pub file_bytes: u64,
    /// Seconds that the bake took.
    pub seconds: f64,
    /// Whether `--model auto` chooses this model.
    pub chosen: bool,
}

/// Returns the normal map of `material`; `None` for other bumps.
pub fn normals(material: &Material) -> Option<&Texture> {
    match &material.bumps {
        Bumps::Normals { texture, .. } => Some(texture),
        Bumps::Flat | Bumps::Offsets { .. } => None,
    }
}
