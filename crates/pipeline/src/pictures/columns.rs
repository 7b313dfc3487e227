//! The columns of a sheet: a material after three bakes, read from the baked files as an engine reads them.

use std::collections::BTreeSet;

use super::error::PictureError;
use crate::bake::{Source, bake_asset};
use crate::codec::Target;
use crate::readback::{ReadBackError, file_name, read_back};
use crate::render::Material;
use crate::settings::{Form, Model, Profile, Settings};

/// A material in all its forms.
pub struct Columns {
    /// Its name, fit for a file name.
    pub name: String,
    /// Plain normal mips in half floats. Level 0 is the reference.
    pub plain: Material,
    /// The portable profile.
    pub portable: Option<Material>,
    /// The pyramid profile.
    pub pyramid: Option<Material>,
}

/// A column that is drawn with filtered textures.
pub struct Column<'a> {
    /// Its heading.
    pub name: &'static str,
    /// What is drawn.
    pub material: &'a Material,
}

impl Columns {
    /// Returns the columns beside the supersampled column.
    pub fn filtered(&self) -> impl Iterator<Item = Column<'_>> {
        let baked = [("portable", &self.portable), ("pyramid", &self.pyramid)];
        let baked = baked.into_iter().filter_map(|(name, material)| Some((name, material.as_ref()?)));
        [("plain", &self.plain)].into_iter().chain(baked).map(|(name, material)| Column { name, material })
    }
}

/// Bakes `source` with `settings` and reads back every material that has bumps on its base layer.
///
/// # Errors
/// [`ReadBackError::NoBumps`] if no material has bumps, and the errors of the bake.
pub fn columns(source: &Source<'_>, settings: &Settings) -> Result<Vec<Columns>, PictureError> {
    let strict = settings.with_gltf(Form::Strict).with_glb(false).with_provenance(false);
    let of_profile = |profile| strict.with_profile(profile);
    let plain = of_profile(Profile::Portable).with_model(Model::None).with_target(Target::Float);
    let plain = read(source, &plain)?;
    let baked = |profile: Profile, wanted: bool| {
        if wanted { read(source, &of_profile(profile)) } else { Ok(Vec::new()) }
    };
    let mut portable = baked(Profile::Portable, settings.profile.is_portable())?.into_iter();
    let mut pyramid = baked(Profile::Pyramid, settings.profile.has_pyramid())?.into_iter();
    let mut taken = BTreeSet::new();
    // Every bake keeps the order of the materials.
    let columns: Vec<Columns> = plain
        .into_iter()
        .map(|(name, plain)| Columns {
            name: file_name(source.stem, &name, &mut taken),
            plain,
            portable: portable.next().map(|(_, material)| material),
            pyramid: pyramid.next().map(|(_, material)| material),
        })
        .collect();
    if columns.is_empty() { Err(ReadBackError::NoBumps.into()) } else { Ok(columns) }
}

/// Bakes `source` and reads back names and materials, in the order of the document.
fn read(source: &Source<'_>, settings: &Settings) -> Result<Vec<(String, Material)>, PictureError> {
    Ok(read_back(source, &bake_asset(source, settings, &|_| {})?, settings.max_texels)?)
}
