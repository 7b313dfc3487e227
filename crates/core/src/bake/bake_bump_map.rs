//! Steps 5 to 8 of one bump map: all its layers, its normal texture and its pyramid. Documents and standalone maps
//! share this sequence.

use crate::bake::bake_layer::{LayerProducts, NormalStep, bake_layer};
use crate::bake::error::BakeError;
use crate::bake::lobes::LayerInput;
use crate::bake::offsets::MapOffsets;
use crate::bake::products::{EncodedTexture, LayerNormals, normal_texture};
use crate::bake::pyramid::{PyramidInput, PyramidProducts, pyramid};

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
/// The first layer whose lobes are on the grid of the bump map decides the normal texture.
pub fn bake_bump_map<'a, 'm>(
    map: &MapOffsets<'m>,
    first: usize,
    layers: impl ExactSizeIterator<Item = Result<LayerInput<'a>, BakeError>>,
    pyramid_inputs: impl FnOnce() -> Vec<PyramidInput>,
) -> Result<BumpMapProducts, BakeError> {
    let count = layers.len();
    let mut products = Vec::with_capacity(count);
    let mut decided: Option<LayerNormals<'m>> = None;
    for (index, layer) in layers.enumerate() {
        let step = NormalStep { decided: decided.as_ref(), first, is_needed_later: index + 1 < count };
        let (layer, normals) = bake_layer(map, layer?, &step)?;
        products.push(layer);
        decided = decided.or(normals);
    }
    let profile = map.settings.profile;
    let normals = profile.is_portable().then(|| normal_texture(map, decided, first)).transpose()?;
    let pyramid =
        if profile.has_pyramid() { pyramid(map, first, pyramid_inputs(), &products)? } else { Default::default() };
    Ok(BumpMapProducts { normals, layers: products, pyramid })
}
