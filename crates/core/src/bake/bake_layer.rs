//! Steps 5 to 8 of one layer: lobes, the choice of a model, and the products.

use crate::bake::choose::{LayerModel, candidates};
use crate::bake::lobes::{LayerInput, LayerLobes};
use crate::bake::offsets::MapOffsets;
use crate::bake::products::{
    EncodedTexture, LayerNormals, base_roughness_texture, lobe_textures, normal_encoding, normals_of_lobes,
    normals_of_means,
};
use crate::codec::EncodeError;
use crate::material::{LobeLevels, Normals, Product, Roughening, notes};
use crate::note::Note;
use crate::settings::Model;

/// What the bake makes of a layer.
pub struct LayerProducts {
    /// The chosen model.
    pub model: LayerModel,
    /// The model for the report: none if no texture can hold the chosen model.
    pub reported_model: Model,
    /// The sum over levels 1 and coarser of the mean trace of the K that the lobes need, for the pyramid profile.
    pub needed_variance: Option<f64>,
    /// The textures of the portable profile: roughness and anisotropy.
    pub textures: Vec<EncodedTexture>,
    /// The texture of the lobes that the pyramid profile adds K to, if the material's own texture does not show them.
    pub base_roughness: Option<EncodedTexture>,
    /// Notes to the user.
    pub notes: Vec<Note>,
}

impl LayerProducts {
    /// Returns the number of textures that the bump map's other layers do not share.
    pub fn texture_count(&self) -> usize {
        self.textures.len() + usize::from(self.base_roughness.is_some())
    }
}

/// The directions of a bump map's texels as far as earlier layers have decided them.
pub struct DirectionStep<'n, 'a> {
    /// The normal texture that an earlier layer has decided.
    pub normals: Option<&'n LayerNormals<'a>>,
    /// The levels of the pyramid profile that an earlier layer has decided.
    pub pyramid: Option<&'n LobeLevels<'a>>,
    /// The finest level that is written of the normal texture.
    pub first: usize,
    /// Whether later layers need the normals.
    pub is_needed_later: bool,
}

/// What a layer decides for all layers of its bump map.
pub struct Decided<'m> {
    /// The normal texture.
    pub normals: Option<LayerNormals<'m>>,
    /// The levels of the pyramid profile.
    pub pyramid: Option<LobeLevels<'m>>,
}

/// Bakes a layer. Returns its products, and what no earlier layer has decided.
pub fn bake_layer<'m>(
    map: &MapOffsets<'m>,
    mut layer: LayerInput<'_>,
    step: &DirectionStep<'_, 'm>,
) -> Result<(LayerProducts, Decided<'m>), EncodeError> {
    let levels = layer.base.levels.take();
    let lobes = LayerLobes::new(map, &layer, levels);
    let deciding = if step.normals.is_none() { normals_of_lobes(map, &lobes) } else { None };
    // Lobes of several layers have several widths, and the lobes of this layer do not stay in memory.
    let deciding = deciding.map(|normals| if step.is_needed_later { normals.by_direction() } else { normals });
    let pyramid = if step.pyramid.is_none() { lobes.pyramid_levels(map) } else { None };
    let earlier = step.normals.and_then(|decided| decided.normals.as_ref());
    let is_undecided = earlier.is_none() && deciding.is_none();
    let means = (map.settings.profile.is_portable() && is_undecided && lobes.roughening.is_some())
        .then(|| normals_of_means(map));
    let normals = earlier.or(deciding.as_ref()).or(means.as_ref());
    let owns_pyramid = pyramid.is_some() && !step.is_needed_later;
    let candidates = candidates(map, &layer, &lobes, normals, step.pyramid.or(pyramid.as_ref()), owns_pyramid);
    let encoding = normal_encoding(map, step.first);
    // The evaluation of candidates waits for its slowest texels several times: normals are encoded meanwhile.
    let (encoded, choice) = rayon::join(
        || deciding.as_ref().map(|normals| normals.encode(encoding)).transpose(),
        || candidates.map(|candidates| candidates.choose()).transpose(),
    );
    let (encoded, choice) = (encoded?, choice?);
    drop((deciding, means));
    let normals = encoded.map(|mip_chain| {
        let lobes = lobes.roughening.as_ref().map(Roughening::lobes).filter(|_| step.is_needed_later);
        let copied = |lobes| Normals::copied_from_lobes(&map.bumps, lobes).with_scale(map.normal_scale);
        LayerNormals { mip_chain, normals: lobes.map(copied) }
    });
    let model = LayerModel::new(choice, &layer, map.settings);
    let pyramid = pyramid.map(|levels| levels.with_base_levels(model.base_levels()));
    let is_held = layer.can_be_roughened || map.settings.profile.has_pyramid();
    let reported_model = if is_held { model.model } else { Model::None };
    let is_stored = map.settings.profile.is_portable() && model.model != Model::None && !layer.keeps_core_lobe;
    let mut products = layer_products(map, model, reported_model, lobes, (layer.first, is_stored))?;
    products.notes.extend(layer.base.note.take());
    Ok((products, Decided { normals, pyramid }))
}

/// Makes the textures of a layer under `model` and frees its lobes. `first` is the finest level that is written of a
/// base lobe, and `is_stored` says whether the core material gets the roughened lobe.
fn layer_products(
    map: &MapOffsets<'_>,
    model: LayerModel,
    reported_model: Model,
    lobes: LayerLobes<'_>,
    (first, is_stored): (usize, bool),
) -> Result<LayerProducts, EncodeError> {
    let lobes = lobes.with_base_levels(model.base_levels());
    let base_roughness = lobes.with_base_texture().filter(|_| model.model != Model::None);
    let base_roughness = base_roughness.map(|roughening| base_roughness_texture(map, roughening, first)).transpose()?;
    let LayerLobes { roughening, needed_variance, .. } = lobes;
    let mut notes: Vec<Note> = model.choice.as_ref().and_then(|choice| choice.note(map.settings)).into_iter().collect();
    let mut textures = Vec::new();
    if let Some(roughening) = roughening.filter(|_| is_stored) {
        textures = lobe_textures(map, &roughening, &model)?;
        notes.extend(notes::of_roughening(&roughening, model.model, map.bump_map.noise()));
        roughening.free();
    }
    Ok(LayerProducts { model, reported_model, needed_variance, textures, base_roughness, notes })
}
