//! Step 2: the layers of all materials are grouped by bump map, and within a group by lobe.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

use serde_json::Value;

use super::geometry::Geometry;
use crate::bump::Frame;
use crate::gltf::geometry::Layout;
use crate::gltf::layers::{LayerKind, LayerRow};
use crate::gltf::material::{AnisotropySource, BumpSource, Layer, Material, ReflectanceFactors, TextureUse};
use crate::gltf::rewrite::Slot;
use crate::gltf::scene::animated_bumps;
use crate::gltf::texture::{ImageLocation, TextureError, TextureSource, Textures};
use crate::mip::Wrap;
use crate::note::{self, Note, Unread};
use crate::settings::{Model, OwnAnisotropy, Settings};

/// A bump map and all layers that use it.
#[derive(Debug)]
pub struct BumpMapGroup {
    /// Image and sampler of the bump map.
    pub source: Arc<TextureSource>,
    /// How the image is read.
    pub kind: BumpMapKind,
    /// Whether the scale of the normal texture may change in all layers.
    pub may_scale_normals: bool,
    /// The layers.
    pub layers: Vec<GroupLayer>,
}

/// How a bump map is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BumpMapKind {
    /// As normals.
    Normals,
    /// As heights.
    Heights {
        /// Slope of a change of the height by 1 over one repeat of the texture, across and up.
        slope_per_repeat: [f32; 2],
        /// Whether texels are taken to be square, whatever the shape of the map.
        square_texels: bool,
        /// The sampler's mode, across and down.
        wrap: [Wrap; 2],
    },
}

/// A layer that uses a bump map.
#[derive(Debug)]
pub struct GroupLayer {
    /// Index into `materials`.
    pub material: usize,
    /// The material's name.
    pub name: String,
    /// The layer.
    pub layer: Layer,
    /// Multiplies offsets: `normalTexture.scale`.
    pub slope_scale: f32,
    /// How the material lies on its meshes, if a frame asks for it.
    pub layout: Option<Layout>,
    /// The anisotropy of the base lobe; none if the bake ignores it.
    pub anisotropy: Option<AnisotropySource>,
    /// Whether the core material keeps its lobe: only the pyramid profile may roughen it.
    pub keeps_core_lobe: bool,
    /// The textures of the base lobe, or why bumps cannot be added to the base lobe texel by texel.
    pub base: Result<BaseTextures, Note>,
    /// Notes to the user.
    pub notes: Vec<Note>,
}

/// The textures of a layer's base lobe.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseTextures {
    /// Green is roughness.
    pub roughness: Option<Arc<TextureSource>>,
    /// Direction and strength.
    pub anisotropy: Option<Arc<TextureSource>>,
    /// What decides on the reflectance; none if the reflectance is constant or cannot be read.
    pub reflectance: Option<ReflectanceTextures>,
}

/// The factors of a layer's reflectance, and those of its textures that lie over the bump map.
#[derive(Clone, Debug, PartialEq)]
pub struct ReflectanceTextures {
    /// The factors.
    pub factors: ReflectanceFactors,
    /// Base colour.
    pub base_colour: Option<Arc<TextureSource>>,
    /// Alpha multiplies the reflectance of the dielectric.
    pub specular: Option<Arc<TextureSource>>,
    /// Colour of the dielectric's F0.
    pub specular_colour: Option<Arc<TextureSource>>,
}

/// What decides on a layer's roughened lobe, besides its bumps. Layers with equal keys share their textures.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct LobeKey {
    kind: LayerKind,
    textures: [Option<usize>; 2],
    factors: [u32; 2],
    anisotropy: Option<[u32; 2]>,
}

/// A material whose layers cannot be grouped.
#[derive(Debug, thiserror::Error)]
#[error("material {material}, {part}: {error}")]
#[non_exhaustive]
pub struct GroupError {
    /// The material's name.
    pub material: String,
    /// The part of the material that refers to a texture.
    pub part: &'static str,
    /// What is wrong with the reference.
    pub error: TextureError,
}

/// Groups the layers of `materials` by bump map, in the order of the file.
///
/// # Errors
/// [`GroupError`] for the first reference that leads nowhere.
pub fn group_by_bump_map(
    root: &Value,
    materials: Vec<Material>,
    settings: &Settings,
    geometry: &Geometry<'_>,
) -> Result<Vec<BumpMapGroup>, GroupError> {
    let mut groups: Vec<BumpMapGroup> = Vec::new();
    let mut indices: HashMap<_, usize> = HashMap::new();
    let mut textures = Textures::of(root);
    let may_scale = settings.effective_scale_normals();
    let animated = if may_scale { animated_bumps(root) } else { BTreeSet::new() };
    for Material { index, name, layers } in materials {
        for layer in layers {
            let (source, kind, layer) = group_layer((index, &name), layer, &mut textures, settings, geometry)?;
            let group = *indices.entry((address(&source), kind.key())).or_insert(groups.len());
            if group == groups.len() {
                groups.push(BumpMapGroup { source, kind, may_scale_normals: may_scale, layers: Vec::new() });
            }
            groups[group].may_scale_normals &= !animated.contains(&index);
            groups[group].layers.push(layer);
        }
    }
    Ok(groups)
}

/// Reads the textures of a layer of `material` (index and name). Returns the bump map and how it is read.
fn group_layer(
    (material, name): (usize, &str),
    layer: Layer,
    textures: &mut Textures<'_>,
    settings: &Settings,
    geometry: &Geometry<'_>,
) -> Result<(Arc<TextureSource>, BumpMapKind, GroupLayer), GroupError> {
    let failed = |part| move |error| GroupError { material: name.to_owned(), part, error };
    let bumps = layer.bumps.texture();
    let source = textures.get(bumps.texture).map_err(failed("normal or height texture"))?;
    let layout = geometry.layout(material, &bumps.mapping);
    let mut notes = Vec::new();
    let (kind, slope_scale) = kind_of(&layer.bumps, &source, settings, layout.as_ref(), || {
        let compressed = |extension| note::compressed_mesh(extension, Unread::RepeatSize);
        notes.push(geometry.compression(material).map_or_else(note::unknown_repeat_size, compressed));
    });
    let anisotropy = layer.anisotropy.clone().filter(|_| settings.effective_own_anisotropy() != OwnAnisotropy::Ignore);
    let mut base = base_textures(textures, &layer, anisotropy.as_ref(), &source)
        .map_err(failed("roughness or anisotropy texture"))?;
    let keeps_core_lobe = anisotropy.is_some() && settings.effective_own_anisotropy() == OwnAnisotropy::Keep;
    if keeps_core_lobe && settings.profile.has_pyramid() {
        notes.push(note::anisotropy_kept());
    } else if keeps_core_lobe {
        base = Err(note::anisotropy_kept());
    }
    if let (Ok(base), Some(reflectance)) = (&mut base, &layer.reflectance) {
        match reflectance {
            Ok(factors) => match reflectance_textures(textures, factors, &layer, &source) {
                Ok(textures) => base.reflectance = Some(textures),
                Err(error) => notes.push(note::unknown_reflectance(&error)),
            },
            Err(error) => notes.push(note::unknown_reflectance(error)),
        }
    }
    let name = name.to_owned();
    let layer = GroupLayer { material, name, layer, slope_scale, layout, anisotropy, keeps_core_lobe, base, notes };
    Ok((source, kind, layer))
}

/// Returns a number by which equal textures can be found, among those that [`Textures`] returned.
fn address(texture: &Arc<TextureSource>) -> usize {
    Arc::as_ptr(texture).addr()
}

/// Returns the bits of a finite number. 0 and -0 have equal bits.
fn bits(number: f32) -> u32 {
    (number + 0.0).to_bits()
}

/// A [`BumpMapKind`] as a key of a map; `None` for normals.
type KindKey = Option<([u32; 2], bool, [Wrap; 2])>;

impl BumpMapKind {
    fn key(&self) -> KindKey {
        match *self {
            Self::Normals => None,
            Self::Heights { slope_per_repeat, square_texels, wrap } => {
                Some((slope_per_repeat.map(bits), square_texels, wrap))
            }
        }
    }
}

/// Returns how a bump map is read, and the factor of its offsets. Calls `note_unknown_repeat` if the size of a repeat
/// of a height map is needed and not known.
fn kind_of(
    bumps: &BumpSource,
    source: &TextureSource,
    settings: &Settings,
    layout: Option<&Layout>,
    note_unknown_repeat: impl FnOnce(),
) -> (BumpMapKind, f32) {
    let scale = match bumps {
        BumpSource::Normals(_, scale) => return (BumpMapKind::Normals, *scale),
        BumpSource::Heights(_, scale) => settings.height_scale.unwrap_or(*scale),
    };
    let (slope_per_repeat, square_texels) = match (settings.frame, layout) {
        // Heights are in mesh units, and the mesh has the size of a repeat.
        (Frame::Natural, Some(layout)) => (layout.units_per_repeat.map(|units| scale / units), false),
        (Frame::Natural, None) => {
            note_unknown_repeat();
            ([scale; 2], true)
        }
        _ => ([scale; 2], true),
    };
    (BumpMapKind::Heights { slope_per_repeat, square_texels, wrap: source.wrap }, 1.0)
}

/// Returns the textures of the layer's base lobe, which has `anisotropy`. The inner error says why bumps cannot be
/// added to the base lobe texel by texel.
fn base_textures(
    textures: &mut Textures<'_>,
    layer: &Layer,
    anisotropy: Option<&AnisotropySource>,
    bumps: &TextureSource,
) -> Result<Result<BaseTextures, Note>, TextureError> {
    let mapping = &layer.bumps.texture().mapping;
    let mut reason = layer.has_other_workflow.then(note::specular_glossiness);
    let mut read = |name: &str, texture: Option<&TextureUse>| {
        let Some(texture) = texture else { return Ok(None) };
        let source = textures.get(texture.texture)?;
        if !texture.mapping.is_same(mapping) {
            reason = Some(note::other_texture_coordinates(name));
        } else if source.wrap != bumps.wrap {
            reason = Some(note::other_wrap_mode(name));
        }
        Ok(Some(source))
    };
    let roughness = read("roughness", layer.roughness.as_ref())?;
    let anisotropy = read("anisotropy", anisotropy.and_then(|a| a.texture.as_ref()))?;
    Ok(match reason {
        Some(reason) => Err(reason),
        None => Ok(BaseTextures { roughness, anisotropy, reflectance: None }),
    })
}

/// Returns the textures of the layer's reflectance. Textures whose texels do not lie over those of the bump map are
/// left out, so that their factors count alone.
fn reflectance_textures(
    textures: &mut Textures<'_>,
    factors: &ReflectanceFactors,
    layer: &Layer,
    bumps: &TextureSource,
) -> Result<ReflectanceTextures, TextureError> {
    let mapping = &layer.bumps.texture().mapping;
    let mut read = |texture: &Option<TextureUse>| {
        let Some(texture) = texture.as_ref().filter(|texture| texture.mapping.is_same(mapping)) else {
            return Ok(None);
        };
        Ok(Some(textures.get(texture.texture)?).filter(|source| source.wrap == bumps.wrap))
    };
    Ok(ReflectanceTextures {
        base_colour: read(&factors.base_colour)?,
        specular: read(&factors.specular)?,
        specular_colour: read(&factors.specular_colour)?,
        factors: factors.clone(),
    })
}

impl BumpMapGroup {
    /// Groups the layers that share each roughened lobe, by the index of the first layer of each group. A layer whose
    /// base lobe cannot be roughened is alone in its group.
    pub fn lobe_groups(&self) -> Vec<Vec<usize>> {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        let mut indices: HashMap<LobeKey, usize> = HashMap::new();
        for (index, layer) in self.layers.iter().enumerate() {
            let new = groups.len();
            let group = layer.lobe_key().map_or(new, |key| *indices.entry(key).or_insert(new));
            if group == new {
                groups.push(Vec::new());
            }
            groups[group].push(index);
        }
        groups
    }
}

impl GroupLayer {
    /// Returns where materials keep layers of this kind.
    pub fn row(&self) -> &'static LayerRow {
        self.layer.kind.row()
    }

    /// Returns the reference to the layer's normal texture.
    pub fn normal_slot(&self) -> Slot {
        self.slot(self.row().normal_texture)
    }

    /// Returns a JSON pointer of the scale of the layer's normal texture.
    pub fn normal_scale(&self) -> String {
        self.pointer(&format!("{}/scale", self.row().normal_texture))
    }

    /// Returns the references to the layer's roughness texture: its own, and the one to occlusion if both share a
    /// texture.
    pub fn roughness_slots(&self) -> Vec<Slot> {
        let mut slots = vec![self.slot(self.row().roughness_texture)];
        if self.layer.occlusion.is_some() && self.layer.occlusion == self.layer.roughness {
            slots.extend(self.row().occlusion_texture.map(|pointer| self.slot(pointer)));
        }
        slots
    }

    /// Returns the reference to the layer's anisotropy texture; none if the layer can only be isotropic.
    pub fn anisotropy_slot(&self) -> Option<Slot> {
        self.row().anisotropy.as_ref().map(|anisotropy| self.slot(anisotropy.texture))
    }

    /// Returns a JSON pointer into the material.
    pub fn pointer(&self, member: &str) -> String {
        format!("/materials/{}/{member}", self.material)
    }

    /// Returns the model with the most parameters that the layer can have.
    pub fn max_model(&self) -> Model {
        let is_ignored = self.layer.anisotropy.is_some() && self.anisotropy.is_none();
        if self.row().anisotropy.is_some() && !is_ignored { Model::Anisotropic } else { Model::Isotropic }
    }

    /// Returns the textures of the base lobe: roughness and anisotropy.
    pub fn base_textures(&self) -> [Option<&TextureSource>; 2] {
        self.base.as_ref().map_or([None; 2], |base| [base.roughness.as_deref(), base.anisotropy.as_deref()])
    }

    /// Returns what decides on the reflectance of the base lobe; none if the reflectance is constant.
    pub fn reflectance(&self) -> Option<&ReflectanceTextures> {
        self.base.as_ref().ok()?.reflectance.as_ref()
    }

    /// Returns the locations of the images of the base lobe and of its reflectance.
    pub fn base_locations(&self) -> Vec<&Arc<ImageLocation>> {
        let reflectance = self.reflectance().map(|r| [&r.base_colour, &r.specular, &r.specular_colour]);
        let reflectance = reflectance.into_iter().flatten().filter_map(Option::as_deref);
        self.base_textures().into_iter().flatten().chain(reflectance).map(|t| &t.location).collect()
    }

    fn slot(&self, member: &str) -> Slot {
        Slot { pointer: self.pointer(member), mapping: self.layer.bumps.texture().mapping.clone() }
    }

    /// Returns the key of the layer's roughened lobe; `None` if the base lobe cannot be roughened.
    fn lobe_key(&self) -> Option<LobeKey> {
        let base = self.base.as_ref().ok()?;
        let anisotropy = self.anisotropy.as_ref().map(|a| [bits(a.strength), bits(a.rotation)]);
        Some(LobeKey {
            kind: self.layer.kind,
            textures: [&base.roughness, &base.anisotropy].map(|texture| texture.as_ref().map(address)),
            factors: [bits(self.layer.roughness_factor), bits(self.slope_scale)],
            anisotropy,
        })
    }
}
