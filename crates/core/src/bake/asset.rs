//! The bake of an asset: a document becomes baked textures and a document that refers to them.

use std::path::PathBuf;

use serde_json::Value;

use super::assemble::Assembly;
use super::bake_group::bake_group;
use super::baked_asset::BakedAsset;
use super::diffuse_light::bumpy_colours;
use super::error::BakeError;
use super::geometry::Geometry;
use super::group::group_by_bump_map;
use super::output_document;
use super::output_sizes::output_sizes;
use super::plain_textures::{PlainTextureOutput, group_plain_textures};
use super::reader::Reader;
use super::source::{Source, SourceError};
use crate::gltf::document::{Container, check_version};
use crate::gltf::material::materials;
use crate::report::{AssetReport, LayerReport};
use crate::settings::Settings;

/// Bakes every material of `source` that has bumps, and encodes other textures if `settings` ask for them. `advance` is
/// called after each bump map and texture with the share of the work that is done. An asset without new textures is
/// returned byte for byte, unless another container is asked for.
///
/// # Errors
/// [`BakeError`] for the first fault of the asset.
pub fn bake_asset(source: &Source<'_>, settings: &Settings, advance: &dyn Fn(f32)) -> Result<BakedAsset, BakeError> {
    let settings = &settings.resolved_for(source.document.container());
    let container = settings.container(source.document.container());
    // Step 1: read the document.
    let root: Value = source.document.json().value("")?.unwrap_or_default();
    check_version(&root)?;
    let materials = materials(&root).into_iter().collect::<Result<Vec<_>, _>>()?;
    check_files(source)?;
    let reader = Reader::new(source, &root, container == Container::Glb || Geometry::is_needed(settings))?;
    let geometry = Geometry::new(&reader, settings);
    let flat: Vec<LayerReport> = materials.iter().filter(|m| m.layers.is_empty()).map(LayerReport::flat).collect();
    // Step 2: group the layers by bump map.
    let groups = group_by_bump_map(&root, materials, settings, &geometry)?;
    let bumpy = bumpy_colours(&root, &groups, settings);
    let plain = group_plain_textures(&root, settings, &bumpy)?;
    let mut assembly = Assembly::new(&reader, settings)?;
    if groups.is_empty() && plain.is_empty() && container == source.document.container() {
        return unchanged(source, flat);
    }
    // Steps 3 to 8 for each bump map; step 9, the assembly, takes each as it comes.
    let steps = (groups.len() + plain.len()) as f32;
    for (done, group) in groups.iter().enumerate() {
        assembly.add(bake_group(group, &reader, &geometry, settings)?)?;
        advance((done + 1) as f32 / steps);
    }
    for (done, texture) in plain.into_iter().enumerate() {
        match texture.bake(&assembly.taken_slots(), &reader, settings)? {
            PlainTextureOutput::Texture(output) => assembly.add(*output)?,
            PlainTextureOutput::Unchanged(notes) => assembly.add_notes(notes),
        }
        advance((groups.len() + done + 1) as f32 / steps);
    }
    assembly.add_notes(bumpy.into_iter().filter_map(|(material, bumpy)| Some((material, bumpy.err()?))));
    assembly.finish(flat)
}

/// Checks that no file of the document is known to be missing, before any work is done.
fn check_files(source: &Source<'_>) -> Result<(), BakeError> {
    let paths = output_document::files(source.document.json())?;
    let paths: Vec<PathBuf> = paths.into_iter().filter(|path| source.files.is_missing(path)).collect();
    if paths.is_empty() { Ok(()) } else { Err(SourceError::Missing { paths }.into()) }
}

/// Returns the asset as it is.
fn unchanged(source: &Source<'_>, layers: Vec<LayerReport>) -> Result<BakedAsset, BakeError> {
    output_document::check_images(source.document.json(), source)?;
    let document = source.document.to_bytes()?;
    let sizes = output_sizes(source.document, document.len(), &[])?;
    Ok(BakedAsset {
        document,
        container: source.document.container(),
        files: Vec::new(),
        copies: output_document::files(source.document.json())?,
        report: AssetReport { layers, sizes, ..AssetReport::default() },
    })
}
