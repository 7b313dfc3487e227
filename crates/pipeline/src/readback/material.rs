//! The materials of a bake, read from its files as an engine reads them.

use std::path::Path;

use serde_json::Value;

use super::error::ReadBackError;
use crate::bake::{BakedAsset, Source};
use crate::decode::decode;
use crate::gltf::document::Document;
use crate::gltf::material::{BumpSource, Layer, LayerKind, materials};
use crate::gltf::roughness_pyramid::{EXTENSION, RoughnessModel, RoughnessPyramid};
use crate::gltf::texture::{ImageLocation, texture_source};
use crate::image::{DecodeOptions, Image, Rgba};
use crate::ktx2::{Ktx2, ReadError};
use crate::mip::{Level, TexelRows};
use crate::render::{BaseAnisotropy, Bumps, LostBumps, Material, RangedTexture, Texture};

/// Returns the names and materials of `baked`, the bake of `source`, in the order of the document. Materials without
/// bumps on their base layer are left out.
///
/// # Errors
/// [`ReadBackError`] for the first material or texture that cannot be read.
pub fn read_back(
    source: &Source<'_>,
    baked: &BakedAsset,
    max_texels: u64,
) -> Result<Vec<(String, Material)>, ReadBackError> {
    let BakedAsset { document, files, .. } = baked;
    let document = Document::parse(document)?;
    let read = |path: &Path| match files.iter().find(|file| file.path == path) {
        Some(file) => Ok(file.bytes.clone()),
        None => source.files.read(path),
    };
    let source = Source::new(source.stem, &document, &read);
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
    fn material(&self, layer: &Layer, pyramid: Option<&Value>) -> Result<Material, ReadBackError> {
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

    fn pyramid(&self, value: &Value) -> Result<(Bumps, LostBumps), ReadBackError> {
        let json = |reason: String| ReadBackError::Extension { material: self.material.to_owned(), reason };
        let pyramid = RoughnessPyramid::read(value).map_err(json)?;
        let ranged = |index: usize, min: &[f64], max: &[f64]| -> Result<RangedTexture, ReadBackError> {
            let at = |bounds: &[f64]| [0, 1, 2].map(|c| bounds.get(c).copied().unwrap_or(0.0));
            Ok(RangedTexture { texture: self.texture(index)?.texture, min: at(min), max: at(max) })
        };
        let bumps = Bumps::Offsets {
            texture: self.texture(pyramid.offset_texture.index)?.texture,
            scale: pyramid.offset_scale,
            has_z: pyramid.has_z(),
        };
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
        Ok((bumps, lost))
    }

    fn texture(&self, index: usize) -> Result<Loaded, ReadBackError> {
        let material = self.material.to_owned();
        let source = texture_source(self.root, index)
            .map_err(|error| ReadBackError::Reference { material: material.clone(), error })?;
        let texture = match &*source.location {
            ImageLocation::Uri(uri) => uri.chars().take(60).collect(),
            ImageLocation::BufferView(view) => format!("bufferViews[{view}]"),
        };
        let bytes = self.source.image(&source.location).map_err(|error| ReadBackError::Source {
            material: material.clone(),
            texture: texture.clone(),
            error,
        })?;
        if bytes.starts_with(&ktx2::MAGIC) {
            return self.ktx2(&bytes).map_err(|error| ReadBackError::Ktx2 { material, texture, error });
        }
        let options = DecodeOptions {
            max_pixels: self.max_texels,
            extension: texture.rsplit_once('.').map(|(_, e)| e.to_owned()),
            ..DecodeOptions::default()
        };
        match decode(&bytes, &options) {
            Ok(image) => Ok(Loaded { channels: image.channels, texture: Texture::with_mips(level(&image)) }),
            Err(error) => Err(ReadBackError::Decode { material, texture, error }),
        }
    }

    /// Reads all levels of a KTX2 file. Makes the missing levels of a file that has one level only.
    fn ktx2(&self, bytes: &[u8]) -> Result<Loaded, ReadError> {
        let file = Ktx2::parse(bytes)?.with_max_texels(self.max_texels);
        let first = file.decode_level(0)?;
        let channels = first.channels;
        let first = level(&first);
        if file.level_count() == 1 {
            return Ok(Loaded { channels, texture: Texture::with_mips(first) });
        }
        let rest = (1..file.level_count()).map(|l| Ok(level(&file.decode_level(l)?)));
        let rest = rest.collect::<Result<Vec<_>, ReadError>>()?;
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
