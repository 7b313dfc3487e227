//! Steps 7 and 8: the textures of the pyramid profile are made and encoded.

use std::sync::Arc;

use crate::bake::bake_layer::LayerProducts;
use crate::bake::offsets::MapOffsets;
use crate::bake::products::EncodedTexture;
use crate::bump::{Frame, Moments};
use crate::codec::EncodeError;
use crate::material::{Encoding, FrameTransforms, Framed, Product, Quantity, QuantityTexture, filter_loss, notes};
use crate::mip::{AreaResampled, Pyramid, TexelRows};
use crate::note::Note;
use crate::report::Content;
use crate::settings::Model;

/// A layer that the pyramid profile describes.
pub struct PyramidInput {
    /// Index of the layer's [`LayerProducts`].
    pub lobes: usize,
    /// The frame of the offsets.
    pub frame: Frame,
    /// The transforms to the frame.
    pub transforms: Arc<FrameTransforms>,
    /// Why the frame is not the requested one.
    pub note: Option<Note>,
}

/// The textures of a layer in the pyramid profile.
pub struct PyramidLayer {
    /// The frame of the offsets.
    pub frame: Frame,
    /// Index of the texture of offsets.
    pub offset: usize,
    /// Index of the texture of D or lambda_1; none under [`Model::None`].
    pub roughness: Option<usize>,
    /// Notes to the user.
    pub notes: Vec<Note>,
}

/// The textures of the pyramid profile.
#[derive(Default)]
pub struct PyramidProducts {
    /// The textures, each of which several layers may share.
    pub textures: Vec<EncodedTexture>,
    /// The layers, in the order of the inputs.
    pub layers: Vec<PyramidLayer>,
}

/// What decides on a texture of one bump map. Layers with equal keys share the texture.
#[derive(Clone, PartialEq)]
struct TextureKey {
    transforms: Arc<FrameTransforms>,
    quantity: Quantity,
    first: usize,
}

/// The textures that have been made, with their keys and notes.
struct Textures<'m, 'a> {
    map: &'m MapOffsets<'a>,
    textures: Vec<EncodedTexture>,
    keys: Vec<(TextureKey, Option<Note>)>,
}

/// Makes the offsets and D or lambda_1 of all `inputs`. Offsets have no levels finer than `first`.
pub fn pyramid(
    map: &MapOffsets<'_>,
    first: usize,
    inputs: Vec<PyramidInput>,
    products: &[LayerProducts],
) -> Result<PyramidProducts, EncodeError> {
    let mut textures = Textures { map, textures: Vec::new(), keys: Vec::new() };
    let layers = inputs
        .into_iter()
        .map(|PyramidInput { lobes, frame, transforms, note }| {
            let chosen = &products[lobes].model;
            let key = |quantity, first| TextureKey { transforms: transforms.clone(), quantity, first };
            let (offset, _) = textures.find_or_make(key(Quantity::Offset, first), Vec::new)?;
            let quantity = match chosen.model {
                Model::Anisotropic => Some(Quantity::Factor),
                Model::Isotropic => Some(Quantity::Lambda1),
                Model::None | Model::Auto => None,
            };
            let roughness =
                quantity.map(|quantity| textures.find_or_make(key(quantity, chosen.first), || chosen.lobe_errors()));
            let (roughness, loss) = roughness.transpose()?.unzip();
            let notes = note.into_iter().chain(loss.flatten()).collect();
            Ok(PyramidLayer { frame, offset, roughness, notes })
        })
        .collect::<Result<_, EncodeError>>()?;
    Ok(PyramidProducts { textures: textures.textures, layers })
}

impl Textures<'_, '_> {
    /// Returns the index and the note of the texture with `key`.
    fn find_or_make(
        &mut self,
        key: TextureKey,
        lobe_errors: impl FnOnce() -> Vec<f32>,
    ) -> Result<(usize, Option<Note>), EncodeError> {
        if let Some(index) = self.keys.iter().position(|(known, _)| *known == key) {
            return Ok((index, self.keys[index].1.clone()));
        }
        let (texture, note) = self.make(&key)?;
        self.textures.push(EncodedTexture { lobe_errors: lobe_errors(), ..texture });
        self.keys.push((key, note.clone()));
        Ok((self.textures.len() - 1, note))
    }

    fn make(&self, key: &TextureKey) -> Result<(EncodedTexture, Option<Note>), EncodeError> {
        if *key.transforms == FrameTransforms::IDENTITY {
            return self.of_moments(self.map.bumps.moments(), key);
        }
        let (width, height) = self.map.bumps.size();
        let framed = Framed { bump_map: self.map.bump_map, transforms: &key.transforms };
        self.of_moments(&Pyramid::new(AreaResampled::new(framed, width, height)), key)
    }

    fn of_moments<R: TexelRows<Texel = Moments>>(
        &self,
        moments: &Pyramid<R>,
        &TextureKey { quantity, first, .. }: &TextureKey,
    ) -> Result<(EncodedTexture, Option<Note>), EncodeError> {
        let encoding = Encoding::of(self.map.settings, quantity.channels() as u32).starting_at(first);
        let texture = QuantityTexture::new(moments, quantity, encoding);
        let mip_chain = texture.encode(encoding)?;
        let (content, model) = match quantity {
            Quantity::Offset => (Content::Offset, Model::None),
            Quantity::Factor => (Content::Factor, Model::Anisotropic),
            Quantity::Lambda1 => (Content::Lambda1, Model::Isotropic),
        };
        let note = (quantity == Quantity::Factor).then(|| notes::of_factor(filter_loss(moments))).flatten();
        Ok((EncodedTexture { content, mip_chain, range: Some(texture.range), model, lobe_errors: Vec::new() }, note))
    }
}
