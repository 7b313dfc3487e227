//! An asset baked: all its jobs, and the document that refers to their textures.

use std::collections::BTreeSet;
use std::path::PathBuf;

use rayon::prelude::*;
use serde_json::Value;

use super::container::{self, ContainerError};
use super::extension::{EXTENSION, Extension, RangedTexture};
use super::geometry::Geometry;
use super::job::{self, JobError, JobOutput, JobTexture, PyramidUse, describe};
use super::names::Names;
use super::plan::{PlanError, plan};
use super::provenance::DocumentProvenance;
use super::pyramids::Range;
use super::report::{AssetReport, LayerReport, TextureReport};
use super::settings::{Form, Settings};
use super::source::{Source, SourceError};
use crate::gltf::document::{Container, Document, DocumentError};
use crate::gltf::json::JsonError;
use crate::gltf::material::{MaterialError, materials};
use crate::gltf::rewrite::{NewImage, NewTexture, add_textures, declare};
use crate::gltf::texture::ImageLocation;
use crate::gltf::uri::{encode_path, relative_path};
use crate::texture::EncodeError;
use crate::texture::ktx2::{Provenance, SourceDigest};

/// Why an asset cannot be baked. Messages name material and texture; the caller adds the file.
#[derive(Debug, thiserror::Error)]
pub enum BakeError {
    /// The document, or its GLB container.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// The document's JSON.
    #[error(transparent)]
    Json(#[from] JsonError),
    /// A material.
    #[error(transparent)]
    Material(#[from] MaterialError),
    /// A reference between objects of the document.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// An image.
    #[error(transparent)]
    Job(#[from] JobError),
    /// A file beside the document.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// The container asked for.
    #[error(transparent)]
    Container(#[from] ContainerError),
}

/// A file to be written beside the document.
#[derive(Clone, Debug, PartialEq)]
pub struct NewFile {
    /// Relative to the document.
    pub path: PathBuf,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// A baked asset, ready to be written.
pub struct Baked {
    /// The document.
    pub document: Vec<u8>,
    /// Which kind of document it is.
    pub container: Container,
    /// New files.
    pub files: Vec<NewFile>,
    /// Files that the document refers to and that did not change, by their paths relative to the document.
    pub copies: Vec<PathBuf>,
    /// What was done.
    pub report: AssetReport,
}

/// Bakes every material of `source` that has bumps. `advance` is called after each bump map with the share of the work
/// that is done. An asset without bumps comes back byte for byte.
///
/// # Errors
/// [`BakeError`] for the first thing that is wrong with the asset; nothing is half done.
pub fn bake(source: &Source<'_>, settings: &Settings, advance: &dyn Fn(f32)) -> Result<Baked, BakeError> {
    let root: Value = source.document.json().value("")?.unwrap_or_default();
    let materials = materials(&root).into_iter().collect::<Result<Vec<_>, _>>()?;
    // References that cannot be followed are an error before any work is done.
    container::files(source.document.json())?;
    source.check_buffers()?;
    let geometry = Geometry::new(&root, source, settings)?;
    let flat: Vec<LayerReport> = materials.iter().filter(|m| m.layers.is_empty()).map(LayerReport::flat).collect();
    let plans = plan(&root, materials, settings, &geometry)?;
    let mut assembly = Assembly::new(source, settings)?;
    for (done, plan) in plans.iter().enumerate() {
        assembly.add(job::run(plan, source, &geometry, settings)?)?;
        advance((done + 1) as f32 / plans.len() as f32);
    }
    assembly.report.layers.extend(flat);
    if plans.is_empty() { untouched(source, assembly.report) } else { assembly.finish() }
}

fn untouched(source: &Source<'_>, report: AssetReport) -> Result<Baked, BakeError> {
    Ok(Baked {
        document: source.document.to_bytes()?,
        container: source.document.container(),
        files: Vec::new(),
        copies: container::files(source.document.json())?,
        report,
    })
}

/// The textures of all jobs, on their way into the document.
struct Assembly<'a> {
    source: &'a Source<'a>,
    settings: &'a Settings,
    document: Document,
    names: Names,
    /// Images that textures tell of.
    told: BTreeSet<ImageLocation>,
    textures: Vec<NewTexture>,
    ranges: Vec<Option<Range>>,
    /// The BIN chunk that became a file.
    bin: Option<NewFile>,
    files: Vec<NewFile>,
    unit_factors: Vec<String>,
    anisotropies: Vec<String>,
    circles: Vec<String>,
    pyramids: Vec<PyramidUse>,
    report: AssetReport,
}

impl<'a> Assembly<'a> {
    fn new(source: &'a Source<'a>, settings: &'a Settings) -> Result<Self, BakeError> {
        let (document, bin) =
            if settings.glb { (container::to_glb(source)?, None) } else { container::to_gltf(source)? };
        Ok(Self {
            source,
            settings,
            document,
            names: Names::new(source.stem),
            told: BTreeSet::new(),
            textures: Vec::new(),
            ranges: Vec::new(),
            bin,
            files: Vec::new(),
            unit_factors: Vec::new(),
            anisotropies: Vec::new(),
            circles: Vec::new(),
            pyramids: Vec::new(),
            report: AssetReport::default(),
        })
    }

    fn add(&mut self, output: JobOutput) -> Result<(), BakeError> {
        let first = self.textures.len();
        let keys = |texture: &JobTexture| match self.settings.provenance {
            true => self.provenance(texture).keys(),
            false => Vec::new(),
        };
        let with_file = |mut texture: JobTexture| {
            let ktx2 = texture.chain.take_ktx2(&keys(&texture)).map_err(EncodeError::from).map_err(JobError::from)?;
            Ok((texture, ktx2))
        };
        let textures = output.textures.into_par_iter().map(with_file).collect::<Result<Vec<_>, JobError>>()?;
        for (texture, ktx2) in textures {
            self.add_texture(texture, ktx2)?;
        }
        for layer in output.layers {
            self.unit_factors.extend(layer.unit_factor);
            self.anisotropies.extend(layer.anisotropy);
            self.circles.extend(layer.circle);
            self.pyramids.extend(layer.pyramid.map(|p| PyramidUse {
                offset: first + p.offset,
                roughness: p.roughness.map(|r| first + r),
                ..p
            }));
            self.report.layers.push(layer.report);
        }
        Ok(())
    }

    fn add_texture(&mut self, texture: JobTexture, ktx2: Vec<u8>) -> Result<(), BakeError> {
        if self.settings.provenance {
            self.told.extend(texture.sources.iter().map(|(location, _)| location.clone()));
        }
        let path = self.names.unique(&stem(&texture), texture.content.name());
        let chain = texture.chain;
        self.report.textures.push(TextureReport {
            path: format!("{path}.ktx2"),
            content: texture.content,
            width: chain.width,
            height: chain.height,
            levels: chain.level_count(),
            trimmed: chain.trimmed,
            bytes: ktx2.len(),
            range: texture.range.clone(),
        });
        let ktx2 = self.add_image(&path, "ktx2", ktx2)?;
        let source = match (chain.fallback, self.settings.form) {
            (Some(png), _) => Some(self.add_image(&path, "png", png)?),
            (None, Form::Dual) => Some(ktx2.clone()),
            (None, _) => None,
        };
        self.ranges.push(texture.range);
        self.textures.push(NewTexture { ktx2, source, sampler: texture.sampler, slots: texture.slots });
        Ok(())
    }

    fn add_image(&mut self, path: &str, extension: &str, bytes: Vec<u8>) -> Result<NewImage, BakeError> {
        if self.settings.glb {
            let view = container::embed(&mut self.document, &bytes)?;
            let mime = if extension == "ktx2" { "image/ktx2" } else { "image/png" };
            return Ok(NewImage::BufferView { view, mime });
        }
        let path = format!("{path}.{extension}");
        let uri = encode_path(&path);
        self.files.push(NewFile { path: PathBuf::from(path), bytes });
        Ok(NewImage::File(uri))
    }

    fn provenance(&self, texture: &JobTexture) -> Provenance {
        let source =
            |(location, blake3): &(_, String)| SourceDigest { uri: describe(location), blake3: blake3.clone() };
        Provenance {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            content: texture.content.name().to_owned(),
            settings: self.settings.to_json(texture.model),
            lobe_errors: texture.lobe_errors.clone(),
            sources: texture.sources.iter().map(source).collect(),
        }
    }

    fn finish(mut self) -> Result<Baked, BakeError> {
        let json = self.document.json_mut();
        if self.settings.provenance && !self.textures.is_empty() {
            let told: Vec<PathBuf> = self.told.iter().filter_map(file).collect();
            DocumentProvenance::new(self.source, |path| told.iter().any(|told| told == path))?.write(json)?;
        }
        // First, so that textures of the material's own lobe count as needed.
        for pyramid in &self.pyramids {
            if let Some(unfolded) = &pyramid.unfolded {
                json.set(&format!("{}/unfolded", pyramid.pointer), unfolded)?;
            }
        }
        let indices = add_textures(json, &self.textures)?;
        for pointer in &self.unit_factors {
            json.set(pointer, &1)?;
        }
        for pointer in &self.anisotropies {
            json.set(&format!("{pointer}/anisotropyStrength"), &1)?;
            json.remove(&format!("{pointer}/anisotropyRotation"))?;
            declare(json, "KHR_materials_anisotropy", false)?;
        }
        for pointer in &self.circles {
            json.set(&format!("{pointer}/anisotropyStrength"), &0)?;
        }
        for pyramid in &self.pyramids {
            // A mirrored relief is as rough.
            let ranged = |index: usize, factor: f32| RangedTexture {
                texture: indices[index],
                range: self.ranges[index].clone().unwrap_or_default().scaled(factor),
            };
            let extension = Extension::new(
                ranged(pyramid.offset, pyramid.slope_scale),
                pyramid.roughness.map(|index| ranged(index, pyramid.slope_scale.abs())),
                pyramid.correction,
                pyramid.frame,
                &pyramid.mapping,
                pyramid.unfolded.clone(),
            );
            json.set(&pyramid.pointer, &extension)?;
            declare(json, EXTENSION, false)?;
        }
        if self.settings.glb {
            container::embed_images(&mut self.document, self.source)?;
        }
        if let Some(mut bin) = self.bin {
            container::trim_views(self.document.json_mut(), self.source.document.json(), &mut bin.bytes)?;
            self.files.push(bin);
        }
        let mut copies = container::files(self.document.json())?;
        copies.retain(|copy| !self.files.iter().any(|file| file.path == *copy));
        self.report.layers.sort_by_key(|layer| (layer.index, layer.layer));
        Ok(Baked {
            document: self.document.to_bytes()?,
            container: self.document.container(),
            files: self.files,
            copies,
            report: self.report,
        })
    }
}

/// The file that an image is, if it is one.
fn file(location: &ImageLocation) -> Option<PathBuf> {
    match location {
        ImageLocation::Uri(uri) => relative_path(uri).ok(),
        ImageLocation::BufferView(_) => None,
    }
}

/// The part of a texture's name that tells what it was made from.
fn stem(texture: &JobTexture) -> String {
    match &texture.named_after {
        Ok(ImageLocation::Uri(uri)) if uri.starts_with("data:") => "image".to_owned(),
        Ok(ImageLocation::Uri(uri)) => {
            let path = relative_path(uri).unwrap_or_else(|_| PathBuf::from(uri));
            path.file_stem().map_or_else(|| "image".to_owned(), |stem| stem.to_string_lossy().into_owned())
        }
        Ok(ImageLocation::BufferView(view)) => format!("image{view}"),
        Err(material) => material.clone(),
    }
}
