//! glTF documents: lossless editing, and reading what materials say. This module knows nothing of pixels.

pub mod density;
pub mod document;
pub mod extensions;
pub mod geometry;
pub mod json;
pub mod material;
pub mod meshes;
pub mod rewrite;
pub mod rotation_map;
pub mod scene;
pub mod texture;
mod triangles;
pub mod uri;
