//! What is to be baked: bumps grouped by their map, and under each the lobes that they roughen.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

use serde_json::Value;

use super::geometry::Geometry;
use crate::bump::Frame;
use crate::gltf::geometry::Layout;
use crate::gltf::material::{BumpSource, Layer, LayerKind, Material, TextureUse};
use crate::gltf::rewrite::Slot;
use crate::gltf::texture::{ImageLocation, TextureError, TextureSource, Textures};
use crate::mip::Wrap;
use crate::settings::Settings;

/// A bump map and all layers that use it.
#[derive(Debug)]
pub struct BumpMapPlan {
    /// Where the map is.
    pub source: Arc<TextureSource>,
    /// How it is read.
    pub kind: BumpMapKind,
    /// Its uses.
    pub layers: Vec<LayerPlan>,
}

/// How a bump map is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BumpMapKind {
    /// As normals.
    Normals,
    /// As heights.
    Heights {
        /// Slope where the height changes by 1 over one repeat of the texture, across and up.
        slope_per_repeat: [f32; 2],
        /// Whether texels are taken to be square, whatever the shape of the map.
        square_texels: bool,
        /// The sampler's mode, across and down.
        wrap: [Wrap; 2],
    },
}

/// A use of a bump map by a layer.
#[derive(Debug)]
pub struct LayerPlan {
    /// Index into `materials`.
    pub material: usize,
    /// The material's name.
    pub name: String,
    /// The layer.
    pub layer: Layer,
    /// Multiplies offsets: `normalTexture.scale`.
    pub slope_scale: f32,
    /// How the material lies on its meshes, where a frame asks for it.
    pub layout: Option<Layout>,
    /// Its own roughness and anisotropy textures, or why nothing can be folded into them.
    pub own: Result<BaseTextures, String>,
    /// What the user should know.
    pub notes: Vec<String>,
}

/// The textures of a layer's own lobe.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseTextures {
    /// Green is roughness.
    pub roughness: Option<Arc<TextureSource>>,
    /// Direction and strength.
    pub anisotropy: Option<Arc<TextureSource>>,
}

/// What a layer's folded lobe depends on, besides its bumps. Layers with equal keys share their textures.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct RoughenedLobeKey {
    kind: LayerKind,
    textures: [Option<usize>; 2],
    factors: [u32; 2],
    anisotropy: Option<[u32; 2]>,
}

/// A material that cannot be planned.
#[derive(Debug, thiserror::Error)]
#[error("material {material}, {part}: {error}")]
pub struct PlanError {
    /// Its name.
    pub material: String,
    /// Which reference.
    pub part: &'static str,
    /// What is wrong with it.
    pub error: TextureError,
}

/// Groups the layers of `materials` by bump map, in the order of the file.
pub fn plan(
    root: &Value,
    materials: Vec<Material>,
    settings: &Settings,
    geometry: &Geometry<'_>,
) -> Result<Vec<BumpMapPlan>, PlanError> {
    let mut bump_maps: Vec<BumpMapPlan> = Vec::new();
    let mut places: HashMap<_, usize> = HashMap::new();
    let mut textures = Textures::of(root);
    for Material { index, name, layers } in materials {
        for layer in layers {
            let failed = |part| {
                let material = name.clone();
                move |error| PlanError { material, part, error }
            };
            let bumps = layer.bumps.texture().clone();
            let source = textures.get(bumps.texture).map_err(failed("normal or height texture"))?;
            let layout = geometry.layout(index, &bumps.mapping);
            let mut notes = Vec::new();
            let (kind, slope_scale) = read_as(&layer.bumps, &source, settings, layout.as_ref(), &mut notes);
            let own =
                textures_of_lobe(&mut textures, &layer, &source).map_err(failed("roughness or anisotropy texture"))?;
            let plan = LayerPlan { material: index, name: name.clone(), layer, slope_scale, layout, own, notes };
            match places.entry((address(&source), kind.key())) {
                Entry::Occupied(place) => bump_maps[*place.get()].layers.push(plan),
                Entry::Vacant(place) => {
                    place.insert(bump_maps.len());
                    bump_maps.push(BumpMapPlan { source, kind, layers: vec![plan] });
                }
            }
        }
    }
    Ok(bump_maps)
}

/// What tells a texture from others, of those that [`Textures`] returned.
fn address(texture: &Arc<TextureSource>) -> usize {
    Arc::as_ptr(texture).addr()
}

/// What tells a finite number from others: 0 and -0 are one.
fn bits(number: f32) -> u32 {
    (number + 0.0).to_bits()
}

/// What tells a [`BumpMapKind`] from others: nothing of normals.
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

fn read_as(
    bumps: &BumpSource,
    source: &TextureSource,
    settings: &Settings,
    layout: Option<&Layout>,
    notes: &mut Vec<String>,
) -> (BumpMapKind, f32) {
    match bumps {
        BumpSource::Normals(_, scale) => (BumpMapKind::Normals, *scale),
        BumpSource::Heights(_, scale) => {
            let scale = settings.height_scale.unwrap_or(*scale);
            let (slope_per_repeat, square_texels) = match (settings.frame, layout) {
                // Heights in mesh units: the slope is what the geometry makes of them.
                (Frame::Natural, Some(layout)) => (layout.units_per_repeat.map(|units| scale / units), false),
                (Frame::Natural, None) => {
                    notes.push(
                        "no mesh shows how large a repeat of the height map is: heights are taken in widths of a repeat"
                            .to_owned(),
                    );
                    ([scale; 2], true)
                }
                _ => ([scale; 2], true),
            };
            (BumpMapKind::Heights { slope_per_repeat, square_texels, wrap: source.wrap }, 1.0)
        }
    }
}

/// The textures of the layer's own lobe. The inner error says why bumps cannot be folded into them texel by texel.
fn textures_of_lobe(
    textures: &mut Textures<'_>,
    layer: &Layer,
    bumps: &TextureSource,
) -> Result<Result<BaseTextures, String>, TextureError> {
    let mapping = &layer.bumps.texture().mapping;
    let mut reason = layer.has_other_workflow.then(|| {
        "KHR_materials_pbrSpecularGlossiness: engines that know it read glossiness, so roughness was left as it was"
            .into()
    });
    let mut read = |what: &str, texture: Option<&TextureUse>| {
        let Some(texture) = texture else { return Ok(None) };
        let source = textures.get(texture.texture)?;
        if !texture.mapping.is_same(mapping) {
            reason = Some(format!(
                "the {what} texture has other texture coordinates or another KHR_texture_transform than the bumps: \
                 its texels do not lie over theirs, so it was left as it was"
            ));
        } else if source.wrap != bumps.wrap {
            reason = Some(format!(
                "the sampler of the {what} texture wraps otherwise than that of the bumps, so it was left as it was"
            ));
        }
        Ok(Some(source))
    };
    let roughness = read("roughness", layer.roughness.as_ref())?;
    let anisotropy = read("anisotropy", layer.anisotropy.as_ref().and_then(|a| a.texture.as_ref()))?;
    Ok(match reason {
        Some(reason) => Err(reason),
        None => Ok(BaseTextures { roughness, anisotropy }),
    })
}

impl LayerPlan {
    /// The place of the layer's normal texture.
    pub fn normal_slot(&self) -> Slot {
        self.slot(match self.layer.kind {
            LayerKind::Base => "normalTexture",
            LayerKind::Clearcoat => "extensions/KHR_materials_clearcoat/clearcoatNormalTexture",
        })
    }

    /// The places that read the layer's roughness texture: its own, and occlusion where it is packed with it.
    pub fn roughness_slots(&self) -> Vec<Slot> {
        let mut slots = vec![self.slot(match self.layer.kind {
            LayerKind::Base => "pbrMetallicRoughness/metallicRoughnessTexture",
            LayerKind::Clearcoat => "extensions/KHR_materials_clearcoat/clearcoatRoughnessTexture",
        })];
        if self.layer.occlusion.is_some() && self.layer.occlusion == self.layer.roughness {
            slots.push(self.slot("occlusionTexture"));
        }
        slots
    }

    /// JSON pointer of the layer's roughness factor.
    pub fn roughness_factor_pointer(&self) -> String {
        self.pointer(match self.layer.kind {
            LayerKind::Base => "pbrMetallicRoughness/roughnessFactor",
            LayerKind::Clearcoat => "extensions/KHR_materials_clearcoat/clearcoatRoughnessFactor",
        })
    }

    /// The place of the anisotropy texture.
    pub fn anisotropy_slot(&self) -> Slot {
        self.slot("extensions/KHR_materials_anisotropy/anisotropyTexture")
    }

    /// A JSON pointer into the material.
    pub fn pointer(&self, member: &str) -> String {
        format!("/materials/{}/{member}", self.material)
    }

    fn slot(&self, member: &str) -> Slot {
        Slot { pointer: self.pointer(member), mapping: self.layer.bumps.texture().mapping.clone() }
    }

    /// What tells the layer's folded lobe from others'; `None` where nothing can be folded.
    pub fn roughened_lobe_key(&self) -> Option<RoughenedLobeKey> {
        let own = self.own.as_ref().ok()?;
        let anisotropy = self.layer.anisotropy.as_ref().map(|a| [bits(a.strength), bits(a.rotation)]);
        Some(RoughenedLobeKey {
            kind: self.layer.kind,
            textures: [&own.roughness, &own.anisotropy].map(|texture| texture.as_ref().map(address)),
            factors: [bits(self.layer.roughness_factor), bits(self.slope_scale)],
            anisotropy,
        })
    }

    /// The layer's own textures, of roughness and of anisotropy.
    pub fn base_textures(&self) -> [Option<&TextureSource>; 2] {
        self.own.as_ref().map_or([None; 2], |own| [own.roughness.as_deref(), own.anisotropy.as_deref()])
    }

    /// Where the layer's own textures are.
    pub fn base_locations(&self) -> Vec<&Arc<ImageLocation>> {
        self.base_textures().into_iter().flatten().map(|t| &t.location).collect()
    }
}
