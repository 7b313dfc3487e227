//! One bump map baked: its normals or offsets, and every lobe that it roughens.

mod error;
mod folds;
mod pyramids;

pub use error::JobError;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use super::extension::BaseLobe;
use super::geometry::Geometry;
use super::plan::{BumpMapKind, BumpMapPlan, LayerPlan};
use super::reader::Reader;
use crate::bump::{Frame, HeightMap, NormalLayout, NormalMap};
use crate::decode::{DecodeError, decode, decode_colours};
use crate::digest::{Digest, digest};
use crate::gltf::density::NoDensity;
use crate::gltf::material::Mapping;
use crate::gltf::rewrite::Slot;
use crate::gltf::texture::{ImageLocation, TextureSource};
use crate::image::{DecodeOptions, Image};
use crate::ktx2::{Ktx2, PROVENANCE_KEY};
use crate::material::{BumpMap, Bumps, MipChain, Range, grid, notes};
use crate::mip::Rows;
use crate::report::{Content, LayerReport};
use crate::settings::{Finest, Model, Settings};

/// A baked texture and where it belongs.
pub struct JobTexture {
    /// What its texels are.
    pub content: Content,
    /// The encoded levels.
    pub mip_chain: MipChain,
    /// What texels of 0 and 1 stand for, in the pyramid profile.
    pub range: Option<Range>,
    /// What its file is named after: an image, or the material that has none.
    pub stem: String,
    /// Images that it was made from, each with the BLAKE3 of its file in hex; none without provenance.
    pub sources: Vec<(Arc<ImageLocation>, Digest)>,
    /// References of materials to it.
    pub slots: Vec<Slot>,
    /// Index into `samplers`.
    pub sampler: Option<usize>,
    /// What it models.
    pub model: Model,
    /// Mean lobe errors of its material, where it holds roughness and was judged.
    pub lobe_errors: Vec<f32>,
}

/// What became of a layer.
pub struct LayerOutcome {
    /// For the report.
    pub report: LayerReport,
    /// c of its roughness, in the pyramid profile.
    pub correction: f32,
    /// What is modelled of the lost bumps, also where the report says that nothing could be folded.
    pub model: Model,
    /// The level with which its roughness data begins.
    pub first: usize,
    /// JSON pointer of the roughness factor, where the texture now holds it.
    pub unit_factor: Option<String>,
    /// JSON pointer of `KHR_materials_anisotropy`, where it was written.
    pub anisotropy: Option<String>,
    /// JSON pointer of `KHR_materials_anisotropy`, where a circle took the place of the material's own ellipse.
    pub dropped_anisotropy: Option<String>,
    /// What the vendor extension says, where it is written.
    pub pyramid: Option<PyramidUse>,
}

/// A layer's part in the pyramid profile.
pub struct PyramidUse {
    /// JSON pointer of the material's extension.
    pub pointer: String,
    /// Which of the job's textures holds offsets.
    pub offset: usize,
    /// Which holds D or lambda_1; none when the model is none.
    pub roughness: Option<usize>,
    /// Multiplies offsets and roughness.
    pub slope_scale: f32,
    /// Texture coordinates of both.
    pub mapping: Mapping,
    /// The frame in which they are read.
    pub frame: Frame,
    /// c.
    pub correction: f32,
    /// The material's own lobe, where the core properties have the folded one.
    pub base_lobe: Option<BaseLobe>,
}

/// What a job produced.
#[derive(Default)]
pub struct JobOutput {
    /// Textures.
    pub textures: Vec<JobTexture>,
    /// Layers, in the plan's order.
    pub layers: Vec<LayerOutcome>,
}

/// Bakes `plan`.
pub fn run(
    plan: &BumpMapPlan,
    reader: &Reader<'_>,
    geometry: &Geometry<'_>,
    settings: &Settings,
) -> Result<JobOutput, JobError> {
    let job = Job { plan, reader, settings, geometry, digests: Mutex::default() };
    // Decoders have one thread each, and normals take the longest.
    let (bump_map, first) = rayon::join(|| job.bump_map(), || plan.layers.first().map(|layer| job.own(layer, None)));
    let (bump_map, mut bump_map_notes) = bump_map?;
    let first = first.transpose()?;
    let size = grid(settings, [(bump_map.width(), bump_map.height())])?;
    let mut output = JobOutput::default();
    bump_map_notes.extend(notes::of_bump_map(&bump_map, size));
    for layer in &plan.layers {
        let mut notes = layer.notes.clone();
        if !plan.source.samples_mips {
            notes.push(
                "the sampler's minFilter never reads mips: the bake has no effect in engines that obey it".into(),
            );
        }
        notes.extend(bump_map_notes.iter().cloned());
        let finest = match job.finest(layer, size) {
            None => None,
            Some(Ok(finest)) => Some(finest),
            Some(Err(reason)) => {
                notes.push(format!("every level counts as seen: {reason}"));
                None
            }
        };
        output.layers.push(LayerOutcome {
            report: LayerReport {
                index: layer.material,
                material: layer.name.clone(),
                layer: layer.layer.kind,
                model: None,
                choice: None,
                finest,
                notes,
            },
            correction: 1.0,
            model: Model::None,
            first: 0,
            unit_factor: None,
            anisotropy: None,
            dropped_anisotropy: None,
            pyramid: None,
        });
    }
    let bumps = Bumps::new(&bump_map, size);
    job.portable(&bump_map, &bumps, first, &mut output)?;
    if settings.profile.has_pyramid() {
        job.pyramids(&bump_map, &bumps, &mut output)?;
    }
    drop(bumps);
    // The system takes memory back page by page, for 10 ms after 4096 x 4096: files are made meanwhile.
    rayon::spawn(|| drop(bump_map));
    Ok(output)
}

/// [`decode`] for bumps, [`crate::decode::decode_colours`] for all else.
type Decode = fn(&[u8], &DecodeOptions) -> Result<Image, DecodeError>;

struct Job<'a> {
    plan: &'a BumpMapPlan,
    reader: &'a Reader<'a>,
    settings: &'a Settings,
    geometry: &'a Geometry<'a>,
    /// BLAKE3 of each image file that was read, for provenance: of the bytes that are baked.
    digests: Mutex<BTreeMap<Arc<ImageLocation>, Digest>>,
}

impl Job<'_> {
    /// The finest level that the view can sample of a map of `size` on `layer`, where a view is told.
    fn finest(&self, layer: &LayerPlan, size: (u32, u32)) -> Option<Result<Finest, NoDensity>> {
        self.geometry.finest(layer.material, &layer.layer.bumps.texture().mapping, size)
    }

    /// The finest level that the view can sample of a map of `size` on any of `layers`: 0 where no one can tell.
    fn finest_level<'l>(&self, layers: impl IntoIterator<Item = &'l LayerPlan>, size: (u32, u32)) -> usize {
        let level = |layer: &LayerPlan| self.finest(layer, size).and_then(Result::ok).map_or(0, |finest| finest.level);
        layers.into_iter().map(level).min().unwrap_or(0)
    }

    /// The first level that is written of such a map.
    fn first_level<'l>(&self, layers: impl IntoIterator<Item = &'l LayerPlan>, size: (u32, u32)) -> usize {
        if self.settings.view.is_some_and(|view| view.trim) { self.finest_level(layers, size) } else { 0 }
    }

    /// The bumps, and what the user should know of them.
    fn bump_map(&self) -> Result<(BumpMap, Vec<String>), JobError> {
        let material = self.plan.layers.first().map(|l| l.name.clone()).unwrap_or_default();
        let file = self.file(&self.plan.source, &material)?;
        let image = self.decoded(&file, &self.plan.source, &material, decode)?;
        let failed = |error| JobError::Map { material, texture: describe(&self.plan.source.location), error };
        let bump_map = match self.plan.kind {
            BumpMapKind::Normals => BumpMap::Normals(NormalMap::new(image, NormalLayout::Auto, false).map_err(failed)?),
            BumpMapKind::Heights { slope_per_repeat: [across, up], square_texels, wrap } => {
                let rows = if square_texels { image.width } else { image.height };
                let slope_per_step = [across * image.width as f32, up * rows as f32];
                BumpMap::Heights { map: HeightMap::new(image).map_err(failed)?, slope_per_step, wrap }
            }
        };
        let notes = if notes::is_jpeg(&file) { vec![notes::JPEG.to_owned()] } else { Vec::new() };
        Ok((bump_map, notes))
    }

    /// Decodes the image of `texture`, which `material` uses for a lobe.
    fn image(&self, texture: &TextureSource, material: &str) -> Result<Image, JobError> {
        let file = self.file(texture, material)?;
        let image = self.decoded(&file, texture, material, decode_colours)?;
        image.into_finite_colours().map_err(|error| JobError::Map {
            material: material.to_owned(),
            texture: describe(&texture.location),
            error,
        })
    }

    /// The bytes of an image file, which [`Self::decoded`] must be given.
    fn file(&self, texture: &TextureSource, material: &str) -> Result<Cow<'_, [u8]>, JobError> {
        self.reader.image_to_hash(&texture.location).map_err(|error| JobError::Source {
            material: material.to_owned(),
            texture: describe(&texture.location),
            error,
        })
    }

    /// Those of `locations` that were read, with their digests.
    fn hashed<'l>(
        &self,
        locations: impl IntoIterator<Item = &'l Arc<ImageLocation>>,
    ) -> Vec<(Arc<ImageLocation>, Digest)> {
        let digests = self.digests.lock().unwrap_or_else(PoisonError::into_inner);
        locations.into_iter().filter_map(|l| Some((l.clone(), *digests.get(l)?))).collect()
    }

    fn decoded(&self, file: &[u8], texture: &TextureSource, material: &str, decode: Decode) -> Result<Image, JobError> {
        let extension = match &*texture.location {
            ImageLocation::Uri(uri) if !uri.starts_with("data:") => uri.rsplit_once('.').map(|(_, e)| e.to_owned()),
            _ => None,
        };
        let options = DecodeOptions { max_pixels: self.settings.max_texels, extension, ..Default::default() };
        let (material, described) = (|| material.to_owned(), || describe(&texture.location));
        let decode = || {
            // A form that cannot be read is no reason to fail: it is not needed.
            let form_is_baked = |form: &Arc<ImageLocation>| self.reader.image(form).is_ok_and(|bytes| is_baked(&bytes));
            if is_baked(file) || texture.other_forms.iter().any(form_is_baked) {
                return Err(JobError::AlreadyBaked { material: material(), texture: described() });
            }
            decode(file, &options).map_err(|error| JobError::Decode {
                material: material(),
                texture: described(),
                error,
            })
        };
        // Decoders have one thread each.
        let (image, digest) = rayon::join(decode, || digest(file));
        self.reader.hashed(&texture.location, digest);
        self.digests.lock().unwrap_or_else(PoisonError::into_inner).insert(texture.location.clone(), digest);
        image
    }
}

fn is_baked(file: &[u8]) -> bool {
    Ktx2::parse(file).is_ok_and(|file| file.key_values().any(|(key, _)| key == PROVENANCE_KEY))
}

/// An image's name for a person.
pub fn describe(location: &ImageLocation) -> String {
    match location {
        ImageLocation::Uri(uri) if uri.starts_with("data:") => {
            format!("{}...", uri.chars().take(32).collect::<String>())
        }
        ImageLocation::Uri(uri) => uri.clone(),
        ImageLocation::BufferView(view) => format!("bufferViews[{view}]"),
    }
}
