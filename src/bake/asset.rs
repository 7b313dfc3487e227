//! An asset baked: all its jobs, and the document that refers to their textures.

use std::collections::{BTreeSet, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rayon::prelude::*;
use serde_json::Value;

use super::compact::compact;
use super::container;
use super::error::BakeError;
use super::extension::{EXTENSION, Extension, RangedTexture};
use super::file::NewFile;
use super::geometry::Geometry;
use super::job::{self, JobError, JobOutput, JobTexture, PyramidUse, describe};
use super::names::Names;
use super::plan::plan;
use super::provenance::DocumentProvenance;
use super::reader::Reader;
use super::source::{Source, SourceError};
use crate::codec::EncodeError;
use crate::digest::Digest;
use crate::gltf::document::{Container, Document, check_version};
use crate::gltf::extensions::declare;
use crate::gltf::material::materials;
use crate::gltf::rewrite::{NewImage, NewTexture, add_textures};
use crate::gltf::texture::ImageLocation;
use crate::gltf::uri::{encode_path, relative_path};
use crate::ktx2::{Provenance, SourceDigest};
use crate::material::Range;
use crate::report::{AssetReport, LayerReport, TextureReport};
use crate::settings::{Form, Settings};

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
    check_version(&root)?;
    let materials = materials(&root).into_iter().collect::<Result<Vec<_>, _>>()?;
    // References that cannot be followed are an error before any work is done.
    let paths = container::files(source.document.json())?;
    let paths: Vec<PathBuf> = paths.into_iter().filter(|path| source.files.is_missing(path)).collect();
    if !paths.is_empty() {
        return Err(SourceError::Missing { paths }.into());
    }
    let reader = Reader::new(source, &root, settings.glb || Geometry::is_needed(settings))?;
    let geometry = Geometry::new(&reader, settings);
    let flat: Vec<LayerReport> = materials.iter().filter(|m| m.layers.is_empty()).map(LayerReport::flat).collect();
    let plans = plan(&root, materials, settings, &geometry)?;
    let mut assembly = Assembly::new(&reader, settings)?;
    for (done, plan) in plans.iter().enumerate() {
        assembly.add(job::run(plan, &reader, &geometry, settings)?)?;
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
    reader: &'a Reader<'a>,
    settings: &'a Settings,
    document: Document,
    names: Names,
    /// Images that textures tell of.
    recorded: BTreeSet<Arc<ImageLocation>>,
    textures: Vec<NewTexture>,
    ranges: Vec<Option<Range>>,
    /// The BIN chunk that became a file.
    bin: Option<NewFile>,
    files: Vec<NewFile>,
    unit_factors: Vec<String>,
    anisotropies: Vec<String>,
    dropped_anisotropies: Vec<String>,
    pyramids: Vec<PyramidUse>,
    report: AssetReport,
}

impl<'a> Assembly<'a> {
    fn new(reader: &'a Reader<'a>, settings: &'a Settings) -> Result<Self, BakeError> {
        let source = reader.source;
        let (document, bin) =
            if settings.glb { (container::to_glb(reader)?, None) } else { container::to_gltf(source)? };
        Ok(Self {
            reader,
            settings,
            document,
            names: Names::new(source.stem),
            recorded: BTreeSet::new(),
            textures: Vec::new(),
            ranges: Vec::new(),
            bin,
            files: Vec::new(),
            unit_factors: Vec::new(),
            anisotropies: Vec::new(),
            dropped_anisotropies: Vec::new(),
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
            let ktx2 =
                texture.mip_chain.take_ktx2(&keys(&texture)).map_err(EncodeError::from).map_err(JobError::from)?;
            Ok((texture, ktx2))
        };
        let textures = output.textures.into_par_iter().map(with_file).collect::<Result<Vec<_>, JobError>>()?;
        for (texture, ktx2) in textures {
            self.add_texture(texture, ktx2)?;
        }
        for layer in output.layers {
            self.unit_factors.extend(layer.unit_factor);
            self.anisotropies.extend(layer.anisotropy);
            self.dropped_anisotropies.extend(layer.dropped_anisotropy);
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
            self.recorded.extend(texture.sources.iter().map(|(location, _)| location.clone()));
        }
        let path = self.names.unique(&texture.stem, texture.content.name());
        let name = path.rsplit('/').next().unwrap_or(&path).to_owned();
        let mip_chain = texture.mip_chain;
        self.report.textures.push(TextureReport {
            path: format!("{path}.ktx2"),
            content: texture.content,
            width: mip_chain.width,
            height: mip_chain.height,
            levels: mip_chain.level_count(),
            trimmed: mip_chain.trimmed,
            bytes: ktx2.len(),
            range: texture.range.clone(),
        });
        let ktx2 = self.add_image(&path, "ktx2", ktx2)?;
        let source = match (mip_chain.fallback, self.settings.form) {
            (Some(png), _) => Some(self.add_image(&path, "png", png)?),
            (None, Form::Dual) => Some(ktx2.clone()),
            (None, _) => None,
        };
        self.ranges.push(texture.range);
        self.textures.push(NewTexture { name, ktx2, source, sampler: texture.sampler, slots: texture.slots });
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
        let source = |(location, blake3): &(Arc<ImageLocation>, Digest)| SourceDigest {
            uri: describe(location),
            blake3: *blake3,
        };
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
        // First, so that textures of the material's own lobe count as needed.
        for pyramid in &self.pyramids {
            if let Some(base_lobe) = &pyramid.base_lobe {
                json.set(&format!("{}/baseLobe", pyramid.pointer), base_lobe)?;
            }
        }
        let indices = add_textures(json, &self.textures)?;
        for pointer in &self.unit_factors {
            json.set(pointer, &1)?;
        }
        for pointer in &self.anisotropies {
            json.set(&format!("{pointer}/anisotropyStrength"), &1)?;
            json.remove(&format!("{pointer}/anisotropyRotation"))?;
        }
        if !self.anisotropies.is_empty() {
            declare(json, "KHR_materials_anisotropy", false)?;
        }
        for pointer in &self.dropped_anisotropies {
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
                pyramid.base_lobe.clone(),
            );
            if !extension.is_finite() {
                return Err(BakeError::NotFinite { pointer: pyramid.pointer.clone() });
            }
            json.set(&pyramid.pointer, &extension)?;
        }
        if !self.pyramids.is_empty() {
            declare(json, EXTENSION, false)?;
        }
        let source = self.reader.source;
        if self.settings.glb {
            container::embed_images(&mut self.document, source)?;
            container::compact_glb(&mut self.document, source.document)?;
        }
        if let Some(NewFile { path, bytes }) = self.bin {
            let bytes = compact(self.document.json_mut(), source.document.json(), bytes)?;
            self.files.extend(bytes.map(|bytes| NewFile { path, bytes }));
        }
        if self.settings.provenance && !self.textures.is_empty() {
            let recorded: BTreeSet<PathBuf> = self.recorded.iter().filter_map(|location| file(location)).collect();
            let provenance = DocumentProvenance::new(self.reader, &self.files, |path| recorded.contains(path))?;
            provenance.write(self.document.json_mut())?;
        }
        let mut copies = container::files(self.document.json())?;
        let made: HashSet<&Path> = self.files.iter().map(|file| file.path.as_path()).collect();
        copies.retain(|copy| !made.contains(copy.as_path()));
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
