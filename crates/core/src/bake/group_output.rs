//! The products of a group of layers, with their places in the document.

use std::sync::Arc;

use super::bake_bump_map::BumpMapProducts;
use super::bake_layer::LayerProducts;
use super::decode::Images;
use super::fill_extension::{BaseLobe, EXTENSION};
use super::group::{BumpMapGroup, GroupLayer};
use super::products::EncodedTexture;
use super::pyramid::PyramidLayer;
use crate::bump::Frame;
use crate::digest::Digest;
use crate::gltf::material::Mapping;
use crate::gltf::rewrite::Slot;
use crate::gltf::texture::{ImageLocation, TextureSource};
use crate::note::{self, Note};
use crate::report::{Content, LayerReport};
use crate::settings::{Finest, MaxModel, Model, Settings};

/// A baked texture and its place in the document.
pub struct GroupTexture {
    /// The texture.
    pub texture: EncodedTexture,
    /// The beginning of its file's name: the name of an image, or of a material without an image.
    pub stem: String,
    /// Its source images with the digests of their bytes.
    pub sources: Vec<(Arc<ImageLocation>, Digest)>,
    /// References of materials to it.
    pub slots: Vec<Slot>,
    /// Index into `samplers`.
    pub sampler: Option<usize>,
}

/// What the bake makes of a layer of a material.
pub struct GroupLayerOutput {
    /// For the report.
    pub report: LayerReport,
    /// JSON pointer and value of the scale of the normal texture, if the texture holds other slopes than before.
    pub normal_scale: Option<(String, f32)>,
    /// JSON pointer of the roughness factor, if the roughness texture now includes the factor.
    pub roughness_factor: Option<String>,
    /// The change of the layer's anisotropy.
    pub anisotropy: AnisotropyChange,
    /// The layer's part in the pyramid profile.
    pub pyramid: Option<PyramidUse>,
}

/// How the bake changes the anisotropy of a layer.
pub enum AnisotropyChange {
    /// The anisotropy stays as it is.
    Unchanged,
    /// A texture holds all of it.
    Baked {
        /// JSON pointer of the strength.
        strength: String,
        /// JSON pointer of the rotation.
        rotation: String,
        /// The extension that defines the anisotropy.
        extension: &'static str,
    },
    /// The isotropic model replaces it.
    Dropped {
        /// JSON pointer of the strength.
        strength: String,
    },
}

/// A layer's part in the pyramid profile.
pub struct PyramidUse {
    /// JSON pointer of the material's extension.
    pub pointer: String,
    /// Index of the texture of offsets.
    pub offset: usize,
    /// Index of the texture of D or lambda_1; none under [`Model::None`].
    pub roughness: Option<usize>,
    /// Multiplies offsets and roughness along the two axes of the frame.
    pub slope_scale: [f32; 2],
    /// Texture coordinates of both textures.
    pub mapping: Mapping,
    /// The frame of the offsets.
    pub frame: Frame,
    /// The correction factor c.
    pub correction: f32,
    /// The base lobe, if the core properties hold the roughened lobe.
    pub base_lobe: Option<BaseLobe>,
    /// Index of the texture of that base lobe, if the bake makes one.
    pub base_roughness: Option<usize>,
}

/// What the bake makes of a group.
pub struct GroupOutput {
    /// The textures: normals, the textures of each lobe, then those of the pyramid profile.
    pub textures: Vec<GroupTexture>,
    /// The layers, in the group's order.
    pub layers: Vec<GroupLayerOutput>,
}

impl GroupOutput {
    /// Places the products of `group` in the document. `notes` returns the finest sampled level of a layer and the
    /// first of its notes.
    pub fn new(
        group: &BumpMapGroup,
        images: &Images<'_>,
        settings: &Settings,
        products: BumpMapProducts,
        lobe_groups: &[Vec<usize>],
        notes: impl Fn(&GroupLayer) -> (Option<Finest>, Vec<Note>),
    ) -> Self {
        let BumpMapProducts { normals, layers: products, pyramid } = products;
        let normal_scale = normals.as_ref().and_then(|texture| texture.scale);
        let mut pyramid_layers = pyramid.layers.into_iter();
        let mut bases = Vec::with_capacity(products.len());
        let mut before = usize::from(normals.is_some());
        for products in &products {
            before += products.texture_count();
            bases.push(products.base_roughness.is_some().then(|| before - 1));
        }
        let mut layers = Vec::with_capacity(group.layers.len());
        for (index, layer) in group.layers.iter().enumerate() {
            let Some(lobes) = lobe_groups.iter().position(|users| users.contains(&index)) else { continue };
            let in_pyramid = if layer.row().is_in_pyramid { pyramid_layers.next() } else { None };
            let (products, base) = (&products[lobes], bases[lobes]);
            let placement = LayerPlacement { layer, products, settings, before_pyramid: before, base, normal_scale };
            layers.push(placement.output(in_pyramid, notes(layer)));
        }
        let places = Places { group, images, has_core_roughness: settings.profile.is_portable() };
        let normals = normals.map(|texture| places.normals(texture));
        let lobes = products.into_iter().zip(lobe_groups).flat_map(|(products, users)| {
            let textures = products.textures.into_iter().chain(products.base_roughness);
            textures.map(|texture| places.of_lobe(texture, users)).collect::<Vec<_>>()
        });
        let pyramid = pyramid.textures.into_iter().map(|texture| places.of_bump_map(texture, Vec::new()));
        Self { textures: normals.into_iter().chain(lobes).chain(pyramid).collect(), layers }
    }
}

/// The places of a group's textures.
struct Places<'a> {
    group: &'a BumpMapGroup,
    images: &'a Images<'a>,
    /// Whether core properties hold the roughened lobe, so that the base lobe stands in the extension alone.
    has_core_roughness: bool,
}

impl Places<'_> {
    fn normals(&self, texture: EncodedTexture) -> GroupTexture {
        self.of_bump_map(texture, self.group.layers.iter().map(GroupLayer::normal_slot).collect())
    }

    /// Places a texture that is made of the bump map alone.
    fn of_bump_map(&self, texture: EncodedTexture, slots: Vec<Slot>) -> GroupTexture {
        let source = &self.group.source;
        GroupTexture {
            texture,
            stem: source.stem(),
            sources: self.images.digests([&source.location]),
            slots,
            sampler: source.sampler,
        }
    }

    /// Places a texture that is made of the bump map and of the base lobe of the layers `users`.
    fn of_lobe(&self, texture: EncodedTexture, users: &[usize]) -> GroupTexture {
        let source = &self.group.source;
        let layer = &self.group.layers[users[0]];
        let [roughness, anisotropy] = layer.base_textures();
        let users = users.iter().map(|user| &self.group.layers[*user]);
        let (replaced, slots): (_, Vec<Slot>) = match texture.content {
            Content::Anisotropy => (anisotropy, users.filter_map(GroupLayer::anisotropy_slot).collect()),
            Content::BaseRoughness if self.has_core_roughness => (roughness, Vec::new()),
            _ => (roughness, users.flat_map(GroupLayer::roughness_slots).collect()),
        };
        GroupTexture {
            texture,
            stem: roughness.map_or_else(|| layer.name.clone(), TextureSource::stem),
            sources: self.images.digests([&source.location].into_iter().chain(layer.base_locations())),
            slots,
            sampler: replaced.map_or(source.sampler, |replaced| replaced.sampler),
        }
    }
}

/// A layer on its way into the document.
struct LayerPlacement<'a> {
    layer: &'a GroupLayer,
    products: &'a LayerProducts,
    settings: &'a Settings,
    /// How many textures stand before those of the pyramid profile.
    before_pyramid: usize,
    /// Index of the texture of the base lobe, if there is one.
    base: Option<usize>,
    /// What multiplies the slopes of the normal texture; none if that is 1.
    normal_scale: Option<f32>,
}

impl LayerPlacement<'_> {
    fn output(
        &self,
        in_pyramid: Option<PyramidLayer>,
        (finest, mut notes): (Option<Finest>, Vec<Note>),
    ) -> GroupLayerOutput {
        let Self { layer, products, settings, .. } = self;
        notes.extend(layer.base.as_ref().err().filter(|_| settings.profile.is_portable()).cloned());
        notes.extend(products.notes.iter().cloned());
        let anisotropy = self.anisotropy_change();
        if matches!(anisotropy, AnisotropyChange::Dropped { .. }) {
            // An engine whose models end with isotropic lobes does not read anisotropy.
            let is_seen = settings.max_model != MaxModel::Isotropic;
            notes.extend(Self::dropping_setting(settings).map(|setting| note::anisotropy_dropped(setting, is_seen)));
        }
        if settings.profile.has_pyramid() && in_pyramid.is_none() {
            notes.push(note::layer_without_pyramid(layer.row().name));
        }
        notes.extend(in_pyramid.iter().flat_map(|in_pyramid| in_pyramid.notes.iter().cloned()));
        let report = LayerReport {
            index: layer.material,
            material: layer.name.clone(),
            layer: layer.layer.kind,
            model: Some(products.reported_model),
            choice: products.model.choice.clone(),
            finest,
            notes,
        };
        let is_factor_baked = self.is_roughened() || self.base.is_some();
        let roughness_factor = is_factor_baked.then(|| layer.pointer(layer.row().roughness_factor));
        let normal_scale = self.normal_scale.map(|scale| (layer.normal_scale(), scale * layer.slope_scale));
        GroupLayerOutput {
            report,
            normal_scale,
            roughness_factor,
            anisotropy,
            pyramid: in_pyramid.map(|used| self.pyramid_use(used)),
        }
    }

    /// Returns the setting that drops anisotropy; `None` if no setting does.
    fn dropping_setting(settings: &Settings) -> Option<&'static str> {
        match (settings.model, settings.max_model) {
            (Model::Isotropic, _) => Some("--model isotropic"),
            (Model::Auto, MaxModel::Isotropic) => Some("--max-model isotropic"),
            _ => None,
        }
    }

    /// Returns whether the core properties hold the roughened lobe.
    fn is_roughened(&self) -> bool {
        !self.products.textures.is_empty()
    }

    fn anisotropy_change(&self) -> AnisotropyChange {
        let Self { layer, products, .. } = self;
        let Some(row) = layer.row().anisotropy.as_ref().filter(|_| self.is_roughened()) else {
            return AnisotropyChange::Unchanged;
        };
        match products.model.model {
            Model::Anisotropic => AnisotropyChange::Baked {
                strength: layer.pointer(row.strength),
                rotation: layer.pointer(row.rotation),
                extension: row.extension,
            },
            Model::Isotropic if layer.anisotropy.is_some() => {
                AnisotropyChange::Dropped { strength: layer.pointer(row.strength) }
            }
            _ => AnisotropyChange::Unchanged,
        }
    }

    fn pyramid_use(&self, in_pyramid: PyramidLayer) -> PyramidUse {
        let layer = self.layer;
        PyramidUse {
            pointer: layer.pointer(&format!("extensions/{EXTENSION}")),
            offset: self.before_pyramid + in_pyramid.offset,
            roughness: in_pyramid.roughness.map(|roughness| self.before_pyramid + roughness),
            slope_scale: in_pyramid.scale.map(|scale| scale * layer.slope_scale),
            mapping: layer.layer.bumps.texture().mapping.clone(),
            frame: in_pyramid.frame,
            correction: in_pyramid.correction,
            base_lobe: self.is_roughened().then(|| BaseLobe::new(layer, self.base.is_some())),
            base_roughness: self.base.filter(|_| self.is_roughened()),
        }
    }
}
