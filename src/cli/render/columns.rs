//! The columns of a sheet: a material after three bakes, read from the baked files as an engine reads them.

use std::collections::BTreeSet;
use std::path::Path;

use serde_json::Value;

use super::RenderError;
use crate::bake::{BakedAsset, Source, bake_asset, fit_name};
use crate::codec::Target;
use crate::decode::decode;
use crate::gltf::document::Document;
use crate::gltf::material::{BumpSource, Layer, LayerKind, materials};
use crate::gltf::roughness_pyramid::{EXTENSION, RoughnessModel, RoughnessPyramid};
use crate::gltf::texture::{ImageLocation, texture_source};
use crate::image::{DecodeOptions, Image, Rgba};
use crate::ktx2::Ktx2;
use crate::mip::{Level, TexelRows};
use crate::render::{BaseAnisotropy, Bumps, LostBumps, Material, RangedTexture, Texture};
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
/// [`RenderError::NoBumps`] when no material has bumps, and the errors of the bake.
pub fn columns(source: &Source<'_>, settings: &Settings) -> Result<Vec<Columns>, RenderError> {
    let strict = settings.with_form(Form::Strict).with_glb(false).with_provenance(false);
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
    if columns.is_empty() { Err(RenderError::NoBumps) } else { Ok(columns) }
}

/// Most bytes of the names of an asset and of a material in the name of a picture or a chart.
const MOST_NAME: usize = 80;

/// Returns a file name: `helmet` and `Glass / Plastic` become `helmet.Glass___Plastic`. Adds a number to a name that is
/// taken.
pub fn file_name(stem: &str, material: &str, taken: &mut BTreeSet<String>) -> String {
    let safe = |c: char| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' };
    let name = fit_name(&material.chars().map(safe).collect::<String>(), MOST_NAME);
    let name = if stem.is_empty() { name } else { format!("{}.{name}", fit_name(stem, MOST_NAME)) };
    let numbered = |n: u32| if n == 1 { name.clone() } else { format!("{name}-{n}") };
    // On case-insensitive file systems, names that differ in case only are one file.
    (1..).map(numbered).find(|name| taken.insert(name.to_lowercase())).unwrap_or_default()
}

/// Bakes `source` and reads back names and materials, in the order of the document.
fn read(source: &Source<'_>, settings: &Settings) -> Result<Vec<(String, Material)>, RenderError> {
    read_back(source, &bake_asset(source, settings, &|_| {})?, settings.max_texels)
}

/// Reads back names and materials with bumps of `baked`, in the order of the document.
pub fn read_back(
    source: &Source<'_>,
    baked: &BakedAsset,
    max_texels: u64,
) -> Result<Vec<(String, Material)>, RenderError> {
    let BakedAsset { document, files, .. } = baked;
    let document = Document::parse(document)?;
    let read = |path: &Path| match files.iter().find(|file| file.path == path) {
        Some(file) => Ok(file.bytes.clone()),
        None => source.files.read(path),
    };
    let source = Source { stem: source.stem, document: &document, files: &read };
    let root: Value = document.json().value("")?.unwrap_or_default();
    let mut found = Vec::new();
    for material in materials(&root) {
        let material = material?;
        if let Some(layer) = material.layers.iter().find(|layer| layer.kind == LayerKind::Base) {
            let reader = Reader { source, root: &root, material: &material.name, max_texels };
            let pyramid = root.pointer(&format!("/materials/{}/extensions/{EXTENSION}", material.index));
            found.push((material.name.clone(), reader.material(layer, pyramid)?));
        }
    }
    Ok(found)
}

/// Reads the textures of one material.
struct Reader<'a> {
    source: Source<'a>,
    root: &'a Value,
    material: &'a str,
    max_texels: u64,
}

impl Reader<'_> {
    fn material(&self, layer: &Layer, pyramid: Option<&Value>) -> Result<Material, RenderError> {
        let roughness = layer.roughness.as_ref().map(|t| self.texture(t.texture)).transpose()?;
        let anisotropy = match &layer.anisotropy {
            None => None,
            Some(a) => {
                let texture = a.texture.as_ref().map(|t| self.texture(t.texture)).transpose()?;
                let (sin, cos) = libm::sincos(f64::from(a.rotation));
                Some(BaseAnisotropy {
                    texture: texture.map(|t| t.texture),
                    strength: a.strength.into(),
                    rotation: [cos, sin],
                })
            }
        };
        let (bumps, lost) = match pyramid {
            Some(value) => self.pyramid(value)?,
            None => match &layer.bumps {
                BumpSource::Normals(texture, scale) => {
                    let Loaded { texture, channels } = self.texture(texture.texture)?;
                    let bumps = Bumps::Normals { texture, scale: f64::from(*scale), has_z: channels > 2 };
                    (bumps, LostBumps::RoughenedTextures)
                }
                // Every bake gives height maps a normal or an offset map.
                BumpSource::Heights(..) => (Bumps::Flat, LostBumps::RoughenedTextures),
            },
        };
        Ok(Material {
            bumps,
            roughness: roughness.map(|t| t.texture),
            roughness_factor: layer.roughness_factor.into(),
            anisotropy,
            lost,
        })
    }

    fn pyramid(&self, value: &Value) -> Result<(Bumps, LostBumps), RenderError> {
        let json = |reason: String| RenderError::Extension { material: self.material.to_owned(), reason };
        let pyramid = RoughnessPyramid::read(value).map_err(json)?;
        let ranged = |index: usize, min: &[f64], max: &[f64]| -> Result<RangedTexture, RenderError> {
            let at = |bounds: &[f64]| [0, 1, 2].map(|c| bounds.get(c).copied().unwrap_or(0.0));
            Ok(RangedTexture { texture: self.texture(index)?.texture, min: at(min), max: at(max) })
        };
        let bumps = ranged(pyramid.offset_texture.index, &pyramid.offset_min, &pyramid.offset_max)?;
        let lost = match (&pyramid.roughness_model, &pyramid.roughness_texture) {
            (Some(model), Some(texture)) => {
                let bounds = |bounds: &Option<Vec<f64>>| bounds.clone().unwrap_or_default();
                let ranged = ranged(texture.index, &bounds(&pyramid.roughness_min), &bounds(&pyramid.roughness_max))?;
                match model {
                    RoughnessModel::CovarianceFactor => LostBumps::Factor(ranged, pyramid.correction_factor),
                    RoughnessModel::StandardDeviation => LostBumps::Lambda1(ranged, pyramid.correction_factor),
                }
            }
            _ => LostBumps::RoughenedTextures,
        };
        Ok((Bumps::Offsets(bumps), lost))
    }

    fn texture(&self, index: usize) -> Result<Loaded, RenderError> {
        let material = self.material.to_owned();
        let source = texture_source(self.root, index)
            .map_err(|error| RenderError::Reference { material: material.clone(), error })?;
        let texture = match &*source.location {
            ImageLocation::Uri(uri) => uri.chars().take(60).collect(),
            ImageLocation::BufferView(view) => format!("bufferViews[{view}]"),
        };
        let bytes = self.source.image(&source.location).map_err(|error| RenderError::Source {
            material: material.clone(),
            texture: texture.clone(),
            error,
        })?;
        if bytes.starts_with(&ktx2::MAGIC) {
            return self.ktx2(&bytes).map_err(|error| RenderError::Ktx2 { material, texture, error });
        }
        let options = DecodeOptions {
            max_pixels: self.max_texels,
            extension: texture.rsplit_once('.').map(|(_, e)| e.to_owned()),
            ..DecodeOptions::default()
        };
        match decode(&bytes, &options) {
            Ok(image) => Ok(Loaded { channels: image.channels, texture: Texture::with_mips(level(&image)) }),
            Err(error) => Err(RenderError::Decode { material, texture, error }),
        }
    }

    /// Reads all levels of a KTX2 file. Makes the missing levels of a file that has one level only.
    fn ktx2(&self, bytes: &[u8]) -> Result<Loaded, crate::ktx2::ReadError> {
        let file = Ktx2::parse(bytes)?.with_max_texels(self.max_texels);
        let first = file.decode_level(0)?;
        let channels = first.channels;
        let first = level(&first);
        if file.level_count() == 1 {
            return Ok(Loaded { channels, texture: Texture::with_mips(first) });
        }
        let rest = (1..file.level_count()).map(|l| Ok(level(&file.decode_level(l)?)));
        let rest = rest.collect::<Result<Vec<_>, crate::ktx2::ReadError>>()?;
        Ok(Loaded { channels, texture: Texture::new(first, rest) })
    }
}

/// A texture, and how many channels it has in the file.
struct Loaded {
    texture: Texture,
    channels: u32,
}

fn level(image: &Image) -> Level<[f32; 4]> {
    let mut texels = vec![[0.0; 4]; image.width as usize * image.height as usize];
    let rows = Rgba(image);
    for (y, row) in (0..).zip(texels.chunks_exact_mut(image.width as usize)) {
        rows.row(y, row);
    }
    Level { width: image.width, height: image.height, texels }
}
