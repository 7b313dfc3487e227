//! Steps 5 to 8 of one bump map: all its layers, its normal texture and its pyramid. Documents and standalone maps
//! share this sequence.

use crate::bake::bake_layer::{DirectionStep, LayerProducts, bake_layer};
use crate::bake::error::BakeError;
use crate::bake::lobes::LayerInput;
use crate::bake::offsets::MapOffsets;
use crate::bake::products::{EncodedTexture, LayerNormals, normal_texture};
use crate::bake::pyramid::{PyramidInput, PyramidProducts, pyramid};
use crate::material::LobeLevels;

/// What the bake makes of a bump map.
pub struct BumpMapProducts {
    /// The normal texture, in the portable profile.
    pub normals: Option<EncodedTexture>,
    /// The products of all layers, in the order of the inputs.
    pub layers: Vec<LayerProducts>,
    /// The textures of the pyramid profile; empty in the portable profile.
    pub pyramid: PyramidProducts,
}

/// Bakes all layers of a bump map. The inputs are asked for when they are needed, since each holds images. The normal
/// texture and the offsets have no levels finer than `first`.
///
/// The first layer whose lobes are on the grid of the bump map decides the normal texture, and offsets and K of the
/// pyramid profile. Callers pass the narrowest of them first.
pub fn bake_bump_map<'a, 'm>(
    map: &MapOffsets<'m>,
    first: usize,
    layers: impl ExactSizeIterator<Item = Result<LayerInput<'a>, BakeError>>,
    pyramid_inputs: impl FnOnce() -> Vec<PyramidInput>,
) -> Result<BumpMapProducts, BakeError> {
    let count = layers.len();
    let mut products = Vec::with_capacity(count);
    let (mut decided, mut levels): (Option<LayerNormals<'m>>, Option<LobeLevels<'m>>) = (None, None);
    for (index, layer) in layers.enumerate() {
        let is_needed_later = index + 1 < count;
        let step = DirectionStep { normals: decided.as_ref(), pyramid: levels.as_ref(), first, is_needed_later };
        let (layer, new) = bake_layer(map, layer?, &step)?;
        products.push(layer);
        (decided, levels) = (decided.or(new.normals), levels.or(new.pyramid));
    }
    let profile = map.settings.profile;
    let normals = profile.is_portable().then(|| normal_texture(map, decided, first)).transpose()?;
    let pyramid = if profile.has_pyramid() {
        pyramid(map, levels.as_ref(), first, pyramid_inputs(), &products)?
    } else {
        PyramidProducts::default()
    };
    Ok(BumpMapProducts { normals, layers: products, pyramid })
}
