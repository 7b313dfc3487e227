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
    /// The asset and the material, as people name them.
    pub title: String,
    /// Plain normal mips in half floats. Level 0 is the reference.
    pub plain: Material,
    /// The portable profile.
    pub portable: Option<Material>,
    /// The pyramid profile.
    pub pyramid: Option<Material>,
}

/// A column that is drawn with filtered textures.
pub struct Column<'a> {
    /// Its name, as in file names.
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

    /// Returns whether the pictures of both are the same: materials of an asset may differ in what no picture
    /// shows, such as colours.
    pub fn look_like(&self, other: &Self) -> bool {
        (&self.plain, &self.portable, &self.pyramid) == (&other.plain, &other.portable, &other.pyramid)
    }
}

/// Returns the name of a column as people read it.
pub fn title_of(column: &str) -> &'static str {
    match column {
        "plain" => "plain mips",
        "portable" => "portable bake",
        "pyramid" => "pyramid bake",
        _ => "supersampled (truth)",
    }
}

/// Bakes `source` with `settings` and reads back every material that has bumps on its base layer. `advance` receives
/// the finished share of the bakes.
///
/// # Errors
/// [`ReadBackError::NoBumps`] if no material has bumps, and the errors of the bake.
pub fn columns(source: &Source<'_>, settings: &Settings, advance: &dyn Fn(f32)) -> Result<Vec<Columns>, PictureError> {
    // Low bumps are stored as the bake of this document stores them.
    let resolved = settings.resolved_for(source.document.container());
    let strict = resolved.with_gltf(Form::Strict).with_glb(false).with_provenance(false);
    let of_profile = |profile| strict.with_profile(profile);
    let plain = of_profile(Profile::Portable).with_model(Model::None).with_target(Target::Float);
    let (has_portable, has_pyramid) = (settings.profile.is_portable(), settings.profile.has_pyramid());
    let bakes = 1 + u8::from(has_portable) + u8::from(has_pyramid);
    let part = |bake: u8| move |share: f32| advance((f32::from(bake) + share) / f32::from(bakes));
    let plain = read(source, &plain, &part(0))?;
    let baked = |profile: Profile, wanted: bool, advance: &dyn Fn(f32)| {
        if wanted { read(source, &of_profile(profile), advance) } else { Ok(Vec::new()) }
    };
    let mut portable = baked(Profile::Portable, has_portable, &part(1))?.into_iter();
    let mut pyramid = baked(Profile::Pyramid, has_pyramid, &part(bakes - 1))?.into_iter();
    let mut taken = BTreeSet::new();
    // Every bake keeps the order of the materials.
    let columns: Vec<Columns> = plain
        .into_iter()
        .map(|(name, plain)| Columns {
            name: file_name(source.stem, &name, &mut taken),
            title: if source.stem.is_empty() { name } else { format!("{}: {name}", source.stem) },
            plain,
            portable: portable.next().map(|(_, material)| material),
            pyramid: pyramid.next().map(|(_, material)| material),
        })
        .collect();
    if columns.is_empty() { Err(ReadBackError::NoBumps.into()) } else { Ok(columns) }
}

/// Bakes `source` and reads back names and materials, in the order of the document.
fn read(
    source: &Source<'_>,
    settings: &Settings,
    advance: &dyn Fn(f32),
) -> Result<Vec<(String, Material)>, PictureError> {
    Ok(read_back(source, &bake_asset(source, settings, advance)?, settings.max_texels)?)
}
