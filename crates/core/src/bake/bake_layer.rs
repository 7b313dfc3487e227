//! Steps 5 to 8 of one layer: lobes, the choice of a model, and the products.

use crate::bake::choose::{LayerModel, candidates};
use crate::bake::lobes::{LayerInput, LayerLobes};
use crate::bake::offsets::MapOffsets;
use crate::bake::products::{EncodedTexture, LayerNormals, lobe_textures, normal_encoding, normals_of_lobes};
use crate::codec::EncodeError;
use crate::material::{Normals, Product, Roughening, notes};
use crate::note::Note;
use crate::settings::Model;

/// What the bake makes of a layer.
pub struct LayerProducts {
    /// The chosen model.
    pub model: LayerModel,
    /// The model for the report: none if no texture can hold the chosen model.
    pub reported_model: Model,
    /// The correction factor c, for the pyramid profile.
    pub correction: Option<f32>,
    /// The textures of the portable profile: roughness and anisotropy.
    pub textures: Vec<EncodedTexture>,
    /// Notes to the user.
    pub notes: Vec<Note>,
}

/// The normal texture of a bump map as far as earlier layers have decided it.
pub struct NormalStep<'n, 'a> {
    /// What an earlier layer has decided.
    pub decided: Option<&'n LayerNormals<'a>>,
    /// The finest level that is written of the normal texture.
    pub first: usize,
    /// Whether later layers need the normals.
    pub is_needed_later: bool,
}

/// Bakes a layer. Returns its products, and the normal texture if this layer decides it.
pub fn bake_layer<'m>(
    map: &MapOffsets<'m>,
    mut layer: LayerInput<'_>,
    step: &NormalStep<'_, 'm>,
) -> Result<(LayerProducts, Option<LayerNormals<'m>>), EncodeError> {
    let levels = layer.base.levels.take();
    let lobes = LayerLobes::new(map, &layer, levels);
    let deciding = if step.decided.is_none() { normals_of_lobes(map, &layer, &lobes) } else { None };
    let earlier = step.decided.and_then(|decided| decided.normals.as_ref());
    let is_undecided = earlier.is_none() && deciding.is_none();
    let means = (map.settings.profile.is_portable() && is_undecided && lobes.roughening.is_some())
        .then(|| Normals::of_means(&map.bumps));
    let candidates = candidates(map, &layer, &lobes, earlier.or(deciding.as_ref()).or(means.as_ref()));
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
        LayerNormals { mip_chain, normals: lobes.map(|lobes| Normals::copied_from_lobes(&map.bumps, lobes)) }
    });
    let model = LayerModel::new(choice, &layer, map.settings);
    let is_held = layer.can_be_roughened || map.settings.profile.has_pyramid();
    let reported_model = if is_held { model.model } else { Model::None };
    Ok((layer_products(map, model, reported_model, lobes)?, normals))
}

/// Makes the textures of a layer under `model` and frees its lobes.
fn layer_products(
    map: &MapOffsets<'_>,
    model: LayerModel,
    reported_model: Model,
    lobes: LayerLobes<'_>,
) -> Result<LayerProducts, EncodeError> {
    let LayerLobes { roughening, correction } = lobes;
    let mut notes: Vec<Note> = model.choice.as_ref().and_then(|choice| choice.note(map.settings)).into_iter().collect();
    let is_stored = map.settings.profile.is_portable() && model.model != Model::None;
    let mut textures = Vec::new();
    if let Some(roughening) = roughening.filter(|_| is_stored) {
        textures = lobe_textures(map, &roughening, &model)?;
        notes.extend(notes::of_roughening(&roughening, model.model, map.bump_map.noise()));
        roughening.free();
    }
    Ok(LayerProducts { model, reported_model, correction, textures, notes })
}
