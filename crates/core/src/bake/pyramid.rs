//! Steps 7 and 8: the textures of the pyramid profile are made and encoded.

use std::sync::Arc;

use crate::bake::bake_layer::LayerProducts;
use crate::bake::offsets::MapOffsets;
use crate::bake::products::EncodedTexture;
use crate::bump::{Frame, FrameTransform};
use crate::codec::EncodeError;
use crate::material::{
    Encoding, FrameTransforms, Framed, LobeLevels, OffsetTexture, Product, PyramidLevels, Quantity, QuantityTexture,
    Rotated, correction_factor, filter_loss, lost_variance, notes,
};
use crate::mip::{AreaResampled, Pyramid};
use crate::note::Note;
use crate::report::Content;
use crate::settings::Model;

/// A layer that the pyramid profile describes.
pub struct PyramidInput {
    /// Index of the layer's [`LayerProducts`].
    pub lobes: usize,
    /// The frame of the offsets.
    pub frame: Frame,
    /// The transforms to the frame, up to its scale.
    pub transforms: Arc<FrameTransforms>,
    /// The scale of the frame: what multiplies slopes along its two axes.
    pub scale: [f32; 2],
    /// Why the frame is not the requested one.
    pub note: Option<Note>,
}

/// The textures of a layer in the pyramid profile.
pub struct PyramidLayer {
    /// The frame of the offsets.
    pub frame: Frame,
    /// The scale of the frame.
    pub scale: [f32; 2],
    /// The correction factor c.
    pub correction: f32,
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

/// What a texture of one bump map holds.
#[derive(Clone, Copy, PartialEq)]
enum Held {
    Offsets,
    Roughness(Quantity),
}

/// What decides on a texture of one bump map. Layers with equal keys share the texture.
#[derive(Clone, PartialEq)]
struct TextureKey {
    transforms: Arc<FrameTransforms>,
    held: Held,
    first: usize,
}

/// A texture that has been made.
struct Made {
    key: TextureKey,
    /// [`lost_variance`] of the levels that the texture is made of; 0 for offsets, which nothing corrects.
    lost_variance: f64,
    note: Option<Note>,
}

/// The textures of a bump map.
struct Textures<'m, 'a> {
    map: &'m MapOffsets<'a>,
    levels: Option<&'m LobeLevels<'a>>,
    textures: Vec<EncodedTexture>,
    made: Vec<Made>,
}

/// Makes the offsets and D or lambda_1 of all `inputs`. `levels` are those of the first layer whose lobes are on the
/// grid of the bump map. Without such a layer, the textures hold means and covariances. Offsets have no levels finer
/// than `first`.
pub fn pyramid<'m>(
    map: &MapOffsets<'m>,
    levels: Option<&LobeLevels<'m>>,
    first: usize,
    inputs: Vec<PyramidInput>,
    products: &[LayerProducts],
) -> Result<PyramidProducts, EncodeError> {
    let mut textures = Textures { map, levels, textures: Vec::new(), made: Vec::new() };
    let layers = inputs.into_iter().map(|input| textures.layer(input, first, products));
    let layers = layers.collect::<Result<_, EncodeError>>()?;
    Ok(PyramidProducts { textures: textures.textures, layers })
}

impl Textures<'_, '_> {
    fn layer(
        &mut self,
        input: PyramidInput,
        first: usize,
        products: &[LayerProducts],
    ) -> Result<PyramidLayer, EncodeError> {
        let PyramidInput { lobes, frame, transforms, scale, note } = input;
        let LayerProducts { model: chosen, needed_variance, .. } = &products[lobes];
        let key = |held, first| TextureKey { transforms: transforms.clone(), held, first };
        let offset = self.find_or_make(key(Held::Offsets, first), Vec::new)?;
        let quantity = match chosen.model {
            Model::Anisotropic => Some(Quantity::Factor),
            Model::Isotropic => Some(Quantity::Lambda1),
            Model::None | Model::Auto => None,
        };
        let key = quantity.map(|quantity| key(Held::Roughness(quantity), chosen.first));
        let roughness = key.map(|key| self.find_or_make(key, || chosen.lobe_errors())).transpose()?;
        let made = roughness.map(|index| &self.made[index]);
        let correction = made.zip(*needed_variance).map(|(made, needed)| correction_factor(needed, made.lost_variance));
        let notes = note.into_iter().chain(made.and_then(|made| made.note.clone())).collect();
        Ok(PyramidLayer { frame, scale, correction: correction.unwrap_or(1.0), offset, roughness, notes })
    }

    /// Returns the index of the texture with `key`.
    fn find_or_make(&mut self, key: TextureKey, lobe_errors: impl FnOnce() -> Vec<f32>) -> Result<usize, EncodeError> {
        if let Some(index) = self.made.iter().position(|made| made.key == key) {
            return Ok(index);
        }
        let (texture, made) = self.make(key)?;
        self.textures.push(EncodedTexture { lobe_errors: lobe_errors(), ..texture });
        self.made.push(made);
        Ok(self.made.len() - 1)
    }

    fn make(&self, key: TextureKey) -> Result<(EncodedTexture, Made), EncodeError> {
        let known: &dyn PyramidLevels = match self.levels {
            Some(levels) => levels,
            None => self.map.bumps.moments(),
        };
        match &*key.transforms {
            FrameTransforms::Uniform(FrameTransform::IDENTITY) => self.of_levels(known, known, key),
            &FrameTransforms::Uniform(transform) => self.of_levels(&Rotated { levels: known, transform }, known, key),
            // Lobes are not known in a frame that differs from texel to texel: moments are merged in that frame.
            transforms @ FrameTransforms::PerTexel(_) => {
                let (width, height) = self.map.bumps.size();
                let framed = Framed { bump_map: self.map.bump_map, transforms };
                let framed = Pyramid::new(AreaResampled::new(framed, width, height));
                self.of_levels(&framed, &framed, key.clone())
            }
        }
    }

    /// Makes a texture of `levels`. `unrotated` are these levels before a rotation, which keeps the trace of K but for
    /// rounding.
    fn of_levels(
        &self,
        levels: &dyn PyramidLevels,
        unrotated: &dyn PyramidLevels,
        key: TextureKey,
    ) -> Result<(EncodedTexture, Made), EncodeError> {
        let settings = self.map.settings;
        match key.held {
            Held::Offsets => {
                let encoding = Encoding::of_normals(settings).starting_at(key.first);
                let texture = OffsetTexture::new(levels, encoding);
                let encoded = EncodedTexture {
                    scale: Some(texture.scale),
                    ..EncodedTexture::new(Content::Offset, texture.encode(encoding)?)
                };
                Ok((encoded, Made { key, lost_variance: 0.0, note: None }))
            }
            Held::Roughness(quantity) => {
                let encoding = Encoding::of(settings, quantity.channels() as u32).starting_at(key.first);
                let texture = QuantityTexture::new(levels, quantity, encoding);
                let (content, model) = match quantity {
                    Quantity::Factor => (Content::Factor, Model::Anisotropic),
                    Quantity::Lambda1 => (Content::Lambda1, Model::Isotropic),
                };
                let mip_chain = texture.encode(encoding)?;
                let note = (quantity == Quantity::Factor).then(|| notes::of_factor(filter_loss(levels))).flatten();
                let range = Some(texture.range);
                let encoded = EncodedTexture { range, model, ..EncodedTexture::new(content, mip_chain) };
                Ok((encoded, Made { key, lost_variance: lost_variance(unrotated), note }))
            }
        }
    }
}

#[cfg(test)]
mod tests;
