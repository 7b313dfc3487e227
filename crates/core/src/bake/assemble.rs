//! Step 9: the textures and layers of all bump maps become a document with its files and a report.

use std::collections::{BTreeSet, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::baked_asset::BakedAsset;
use super::compact::compact;
use super::error::BakeError;
use super::fill_extension::{EXTENSION, Extension, RangedTexture, ScaledTexture};
use super::group_output::{AnisotropyChange, GroupOutput, GroupTexture, PyramidUse};
use super::ktx2_files::ktx2_files;
use super::names::Names;
use super::new_file::NewFile;
use super::output_document;
use super::output_sizes::output_sizes;
use super::provenance::DocumentProvenance;
use super::reader::Reader;
use crate::gltf::document::{Container, Document};
use crate::gltf::extensions::declare;
use crate::gltf::json::Json;
use crate::gltf::layers::LayerKind;
use crate::gltf::rewrite::{NewImage, NewTexture, add_textures, name_ktx2_sources};
use crate::gltf::texture::ImageLocation;
use crate::gltf::uri::{encode_path, relative_path};
use crate::material::Range;
use crate::note::Note;
use crate::report::{AssetReport, LayerReport};
use crate::settings::{Form, Settings};

/// What the texels of a texture of the pyramid profile stand for.
struct StoredValues {
    range: Range,
    scale: f32,
    has_z: bool,
}

/// The textures and layers of all bump maps, on their way into the document.
pub struct Assembly<'a> {
    reader: &'a Reader<'a>,
    settings: &'a Settings,
    document: Document,
    names: Names,
    /// Images whose digests textures record.
    recorded: BTreeSet<Arc<ImageLocation>>,
    textures: Vec<NewTexture>,
    stored: Vec<StoredValues>,
    /// The BIN chunk of a .glb that becomes a file.
    bin: Option<NewFile>,
    files: Vec<NewFile>,
    /// JSON pointers of roughness factors that textures now include.
    normal_scales: Vec<(String, f32)>,
    roughness_factors: Vec<String>,
    anisotropies: Vec<AnisotropyChange>,
    pyramids: Vec<PyramidUse>,
    report: AssetReport,
}

impl<'a> Assembly<'a> {
    /// Starts with a copy of the source document in the container of `settings`, which are resolved for the document.
    pub fn new(reader: &'a Reader<'a>, settings: &'a Settings) -> Result<Self, BakeError> {
        let source = reader.source;
        let (document, bin) = match settings.container(source.document.container()) {
            Container::Glb => (output_document::to_glb(reader)?, None),
            Container::Gltf => output_document::to_gltf(source)?,
        };
        Ok(Self {
            reader,
            settings,
            document,
            names: Names::new(source.output_stem),
            recorded: BTreeSet::new(),
            textures: Vec::new(),
            stored: Vec::new(),
            bin,
            files: Vec::new(),
            normal_scales: Vec::new(),
            roughness_factors: Vec::new(),
            anisotropies: Vec::new(),
            pyramids: Vec::new(),
            report: AssetReport::default(),
        })
    }

    /// Returns JSON pointers of the references that have a new texture.
    pub fn taken_slots(&self) -> BTreeSet<&str> {
        self.textures.iter().flat_map(|texture| &texture.slots).map(|slot| slot.pointer.as_str()).collect()
    }

    /// Adds the textures and layers of a bump map, or a texture that belongs to none.
    pub fn add(&mut self, output: GroupOutput) -> Result<(), BakeError> {
        let first = self.textures.len();
        for (texture, ktx2) in ktx2_files(output.textures, self.settings)? {
            self.add_texture(texture, ktx2)?;
        }
        for layer in output.layers {
            self.normal_scales.extend(layer.normal_scale);
            self.roughness_factors.extend(layer.roughness_factor);
            self.anisotropies.push(layer.anisotropy);
            self.pyramids.extend(layer.pyramid.map(|used| PyramidUse {
                offset: first + used.offset,
                roughness: used.roughness.map(|roughness| first + roughness),
                base_roughness: used.base_roughness.map(|base| first + base),
                ..used
            }));
            self.report.layers.push(layer.report);
        }
        Ok(())
    }

    /// Adds notes on the base layers of the materials of the indices, whose bump maps were added before.
    pub fn add_notes(&mut self, notes: impl IntoIterator<Item = (usize, Note)>) {
        for (material, note) in notes {
            let is_base = |layer: &&mut LayerReport| layer.index == material && layer.layer == LayerKind::Base;
            self.report.layers.iter_mut().filter(is_base).for_each(|layer| layer.notes.push(note.clone()));
        }
    }

    fn add_texture(
        &mut self,
        GroupTexture { texture, stem, sources, slots, sampler }: GroupTexture,
        ktx2: Vec<u8>,
    ) -> Result<(), BakeError> {
        if self.settings.provenance {
            self.recorded.extend(sources.into_iter().map(|(location, _)| location));
        }
        let path = self.names.unique(&stem, texture.content.name());
        let name = path.rsplit('/').next().unwrap_or(&path).to_owned();
        self.report.textures.push(texture.report(format!("{path}.ktx2"), ktx2.len()));
        let ktx2 = self.add_image(&path, "ktx2", ktx2)?;
        let source = match (texture.mip_chain.fallback, self.settings.gltf) {
            (Some(png), _) => Some(self.add_image(&path, "png", png)?),
            (None, Form::Dual) => Some(ktx2.clone()),
            (None, _) => None,
        };
        self.stored.push(StoredValues {
            range: texture.range.unwrap_or_default(),
            scale: texture.scale.unwrap_or(1.0),
            has_z: texture.mip_chain.format.has_z(),
        });
        self.textures.push(NewTexture { name, ktx2, source, sampler, slots });
        Ok(())
    }

    fn add_image(&mut self, path: &str, extension: &str, bytes: Vec<u8>) -> Result<NewImage, BakeError> {
        if self.document.container() == Container::Glb {
            let view = output_document::embed(&mut self.document, &bytes)?;
            let mime = if extension == "ktx2" { "image/ktx2" } else { "image/png" };
            return Ok(NewImage::BufferView { view, mime });
        }
        let path = format!("{path}.{extension}");
        let uri = encode_path(&path);
        self.files.push(NewFile { path: PathBuf::from(path), bytes });
        Ok(NewImage::File(uri))
    }

    /// Writes the document. The report gets the layers without bumps, too.
    pub fn finish(mut self, flat: Vec<LayerReport>) -> Result<BakedAsset, BakeError> {
        let json = self.document.json_mut();
        // Base lobes are written first, so that their textures count as needed when textures are added.
        write_base_lobes(json, &self.pyramids)?;
        let indices = add_textures(json, &self.textures)?;
        for (pointer, scale) in &self.normal_scales {
            json.set(pointer, scale)?;
        }
        write_factors(json, &self.roughness_factors, &self.anisotropies)?;
        write_pyramids(json, &self.pyramids, &indices, &self.stored)?;
        self.finish_container()?;
        self.write_provenance()?;
        let mut copies = output_document::files(self.document.json())?;
        let new: HashSet<&Path> = self.files.iter().map(|file| file.path.as_path()).collect();
        copies.retain(|copy| !new.contains(copy.as_path()));
        let document = self.document.to_bytes()?;
        self.report.sizes = output_sizes(&self.document, document.len(), &self.files)?;
        self.report.layers.extend(flat);
        self.report.layers.sort_by_key(|layer| (layer.index, layer.layer));
        Ok(BakedAsset {
            document,
            container: self.document.container(),
            files: self.files,
            copies,
            report: self.report,
        })
    }

    /// Moves files into a .glb, and removes what only replaced images needed from the binary chunk.
    fn finish_container(&mut self) -> Result<(), BakeError> {
        let source = self.reader.source;
        output_document::check_images(self.document.json(), source)?;
        if self.document.container() == Container::Glb {
            let has_moved = output_document::embed_images(&mut self.document, source)?;
            if has_moved || self.is_rewritten() {
                name_ktx2_sources(self.document.json_mut())?;
            }
            output_document::compact_glb(&mut self.document, source.document)?;
        }
        if let Some(NewFile { path, bytes }) = self.bin.take() {
            let bytes = compact(self.document.json_mut(), source.document.json(), bytes)?;
            self.files.extend(bytes.map(|bytes| NewFile { path, bytes }));
        }
        Ok(())
    }

    /// Returns whether the document has new textures or another container than its source.
    fn is_rewritten(&self) -> bool {
        !self.textures.is_empty() || self.document.container() != self.reader.source.document.container()
    }

    fn write_provenance(&mut self) -> Result<(), BakeError> {
        // A document that only changed its container shows by its record what it was made of.
        if self.settings.provenance && self.is_rewritten() {
            let recorded: BTreeSet<PathBuf> = self.recorded.iter().filter_map(|location| file_of(location)).collect();
            let provenance = DocumentProvenance::new(self.reader, &self.files, |path| recorded.contains(path))?;
            provenance.write(self.document.json_mut())?;
        }
        Ok(())
    }
}

fn write_base_lobes(json: &mut Json, pyramids: &[PyramidUse]) -> Result<(), BakeError> {
    for pyramid in pyramids {
        if let Some(base_lobe) = &pyramid.base_lobe {
            json.set(&format!("{}/baseLobe", pyramid.pointer), base_lobe)?;
        }
    }
    Ok(())
}

/// Sets the factors of textures that include them, and of anisotropies that are replaced.
fn write_factors(
    json: &mut Json,
    roughness_factors: &[String],
    anisotropies: &[AnisotropyChange],
) -> Result<(), BakeError> {
    for pointer in roughness_factors {
        json.set(pointer, &1)?;
    }
    let mut extensions = BTreeSet::new();
    for change in anisotropies {
        if let AnisotropyChange::Baked { strength, rotation, extension } = change {
            json.set(strength, &1)?;
            json.remove(rotation)?;
            extensions.insert(*extension);
        }
    }
    for extension in extensions {
        declare(json, extension, false)?;
    }
    for change in anisotropies {
        if let AnisotropyChange::Dropped { strength } = change {
            json.set(strength, &0)?;
        }
    }
    Ok(())
}

/// Writes the extension of the pyramid profile. `indices` and `stored` are those of all new textures.
fn write_pyramids(
    json: &mut Json,
    pyramids: &[PyramidUse],
    indices: &[usize],
    stored: &[StoredValues],
) -> Result<(), BakeError> {
    for pyramid in pyramids {
        let [across, up] = pyramid.slope_scale;
        let StoredValues { scale, has_z, .. } = stored[pyramid.offset];
        let offset = ScaledTexture { texture: indices[pyramid.offset], has_z, scale: [scale * across, scale * up] };
        let ranged = |index: usize| {
            let range = stored[index].range.clone();
            // The rows of D are along the axes of the frame: (d1, d2) and (0, d3). A negative scale mirrors the offsets
            // and leaves the roughness unchanged.
            let range = match range.max.len() {
                3 => range.scaled([across.abs(), across.abs(), up.abs()]),
                _ => range.scaled([isotropic_scale(pyramid.slope_scale); 3]),
            };
            RangedTexture { texture: indices[index], range }
        };
        let base_lobe = pyramid.base_lobe.clone().map(|lobe| match pyramid.base_roughness {
            Some(texture) => lobe.with_texture(indices[texture], &pyramid.mapping),
            None => lobe,
        });
        let extension = Extension::new(
            offset,
            pyramid.roughness.map(ranged),
            pyramid.correction,
            pyramid.frame,
            &pyramid.mapping,
            base_lobe,
        );
        if !extension.is_finite() {
            return Err(BakeError::NotFinite { pointer: pyramid.pointer.clone() });
        }
        json.set(&pyramid.pointer, &extension)?;
    }
    if !pyramids.is_empty() {
        declare(json, EXTENSION, false)?;
    }
    Ok(())
}

/// Returns the scale of lambda_1 in a frame of the scale (s, t). A reader divides the variance along the two axes by
/// s^2 and t^2, and takes the mean where lobes are isotropic.
fn isotropic_scale([s, t]: [f32; 2]) -> f32 {
    let inverse = 0.5 * (1.0 / (s * s) + 1.0 / (t * t));
    if inverse.is_finite() { (1.0 / inverse).sqrt() } else { 0.0 }
}

/// Returns the path of an image that is a file.
fn file_of(location: &ImageLocation) -> Option<PathBuf> {
    match location {
        ImageLocation::Uri(uri) => relative_path(uri).ok(),
        ImageLocation::BufferView(_) => None,
    }
}
