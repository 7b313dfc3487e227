//! Checks of the materials of a baked document: their references, extensions and tangent spaces.

use std::collections::BTreeSet;

use ::gltf::json::Root;
use ::gltf::json::validation::Checked;
use ::gltf::mesh::Semantic;
use serde_json::Value;

use super::findings::{Code, Findings};
use super::texture_references::Textures;
use crate::gltf::layers::{LAYERS, member};
use crate::gltf::plain_textures::{Meaning, plain_textures};
use crate::gltf::rewrite::references;
use crate::gltf::roughness_pyramid::{EXTENSION, RoughnessPyramid};

/// How the materials of a document use textures.
#[derive(Default)]
pub struct Uses {
    /// Textures that normals are read from.
    pub normals: BTreeSet<usize>,
    /// Textures that sRGB colours are read from.
    pub colours: BTreeSet<usize>,
    /// Extensions that satisfy their schema, with their JSON pointers.
    pub pyramids: Vec<(String, RoughnessPyramid)>,
}

/// Checks references, extensions and tangent spaces of all materials.
pub fn check_materials(root: &Root, value: &Value, textures: &Textures, findings: &mut Findings) -> Uses {
    let mut uses = Uses::default();
    let plain = plain_textures(value).into_iter().filter(|plain| matches!(plain.meaning, Meaning::Colour(_)));
    uses.colours.extend(plain.map(|plain| plain.texture));
    let count = textures.len();
    let of_materials = references(value).into_iter().filter(|(pointer, _)| pointer.starts_with("/materials/"));
    for (pointer, texture) in of_materials {
        if texture >= count {
            let message = format!("expected an index below {count}, found {texture}; bake again");
            findings.add(Code::BadReference, format!("{pointer}/index"), message);
        } else if is_normal_texture(&pointer) {
            uses.normals.insert(texture);
        }
    }
    for (index, material) in root.materials.iter().enumerate() {
        let extension = |name: &str| material.extensions.as_ref()?.others.get(name);
        if let Some(found) = extension(EXTENSION) {
            let pointer = format!("/materials/{index}/extensions/{EXTENSION}");
            match RoughnessPyramid::read(found) {
                Ok(pyramid) => {
                    uses.normals.insert(pyramid.offset_texture.index);
                    uses.pyramids.push((pointer, pyramid));
                }
                Err(reason) => {
                    let message = format!(
                        "expected what schemas/material.{EXTENSION}.schema.json describes, found: {reason}; bake again"
                    );
                    findings.add(Code::ExtensionSchema, pointer, message);
                }
            }
        }
    }
    check_tangents(root, findings);
    uses
}

/// Returns whether `pointer` leads to the normal texture of a layer.
fn is_normal_texture(pointer: &str) -> bool {
    let name = pointer.rsplit('/').next();
    LAYERS.iter().any(|row| name == Some(member(row.normal_texture)))
}

/// Checks that meshes have tangents where `KHR_materials_anisotropy` needs them: by its section "Anisotropy", the
/// tangent space of a material without a normal texture comes from the mesh.
fn check_tangents(root: &Root, findings: &mut Findings) {
    let needs_tangents = |index: usize| {
        let Some(material) = root.materials.get(index) else { return false };
        let extensions = material.extensions.as_ref().map(|e| &e.others);
        extensions.is_some_and(|e| e.contains_key("KHR_materials_anisotropy")) && material.normal_texture.is_none()
    };
    for (mesh, primitives) in root.meshes.iter().map(|m| &m.primitives).enumerate() {
        for (primitive, p) in primitives.iter().enumerate() {
            let has_tangents = p.attributes.keys().any(|key| matches!(key, Checked::Valid(Semantic::Tangents)));
            let Some(material) = p.material.map(|m| m.value()).filter(|m| !has_tangents && needs_tangents(*m)) else {
                continue;
            };
            let message = format!(
                "expected a normalTexture in material {material} or TANGENT in its meshes, found neither: the direction \
                 of the anisotropy is undefined; export the mesh with tangents"
            );
            findings.add(Code::NoTangentSpace, format!("/meshes/{mesh}/primitives/{primitive}"), message);
        }
    }
}
