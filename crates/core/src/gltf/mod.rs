//! glTF documents: lossless editing, and reading of materials and meshes. This module does not know pixels.

pub mod document;
pub mod extensions;
pub mod geometry;
pub mod json;
pub mod layers;
pub mod material;
pub mod meshes;
pub mod plain_textures;
pub mod rewrite;
pub mod rotation_map;
pub mod roughness_pyramid;
pub mod scene;
#[cfg(test)]
mod test_meshes;
pub mod texel_size;
pub mod texture;
mod triangles;
pub mod uri;
