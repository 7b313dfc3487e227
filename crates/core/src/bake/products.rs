//! Steps 7 and 8: the textures of the portable profile are made and encoded.

use crate::bake::choose::LayerModel;
use crate::bake::lobes::LayerLobes;
use crate::bake::offsets::MapOffsets;
use crate::codec::EncodeError;
use crate::material::{
    AnisotropyTexture, BaseRoughnessTexture, Encoding, MipChain, Normals, Product, Range, Roughening, RoughnessTexture,
};
use crate::report::{Content, TextureReport};
use crate::settings::{DiffuseLight, Model};

/// A baked texture whose levels are encoded in memory, and which is no file yet.
pub struct EncodedTexture {
    /// What its texels are.
    pub content: Content,
    /// The encoded levels.
    pub mip_chain: MipChain,
    /// What texels of 0 and 1 stand for, in textures of D and lambda_1.
    pub range: Option<Range>,
    /// What multiplies the slopes of normals: in textures of offsets, and in normal textures of low bumps.
    pub scale: Option<f32>,
    /// The light that its mips are darkened for; none if mips are means.
    pub diffuse_light: Option<DiffuseLight>,
    /// What it models of the lost bumps.
    pub model: Model,
    /// Mean lobe errors of its layer, level by level, if it holds roughness data that were chosen.
    pub lobe_errors: Vec<f32>,
}

impl EncodedTexture {
    /// Makes a texture without range, scale and model.
    pub fn new(content: Content, mip_chain: MipChain) -> Self {
        Self {
            content,
            mip_chain,
            range: None,
            scale: None,
            diffuse_light: None,
            model: Model::None,
            lobe_errors: Vec::new(),
        }
    }

    /// Returns the report of the texture as a KTX2 file of `bytes` bytes at `path`.
    pub fn report(&self, path: String, bytes: usize) -> TextureReport {
        TextureReport {
            path,
            content: self.content,
            width: self.mip_chain.width,
            height: self.mip_chain.height,
            levels: self.mip_chain.level_count(),
            trimmed: self.mip_chain.trimmed,
            bytes,
            range: self.range.clone(),
            scale: self.scale,
            diffuse_light: self.diffuse_light,
        }
    }
}

/// The normal texture that the lobes of a layer decided.
pub struct LayerNormals<'a> {
    /// The encoded levels.
    pub mip_chain: MipChain,
    /// The normals, for later layers.
    pub normals: Option<Normals<'a>>,
}

/// Returns the normals that `lobes` decide: the directions of the lobes, if they are on the grid of the bump map.
pub fn normals_of_lobes<'a, 'm: 'a>(map: &MapOffsets<'m>, lobes: &'a LayerLobes<'a>) -> Option<Normals<'a>> {
    let roughening = lobes.deciding().filter(|_| map.settings.profile.is_portable())?;
    Some(Normals::of_lobes(&map.bumps, roughening.lobes()).with_scale(map.normal_scale))
}

/// Returns the normals of mean slopes.
pub fn normals_of_means<'m>(map: &MapOffsets<'m>) -> Normals<'m> {
    Normals::of_means(&map.bumps).with_scale(map.normal_scale)
}

/// Returns the encoding of a bump map's normal texture, without levels finer than `first`.
pub fn normal_encoding(map: &MapOffsets<'_>, first: usize) -> Encoding {
    Encoding::of_normals(map.settings).starting_at(first)
}

/// Makes the normal texture: the one that a layer decided, else mean slopes.
pub fn normal_texture(
    map: &MapOffsets<'_>,
    decided: Option<LayerNormals<'_>>,
    first: usize,
) -> Result<EncodedTexture, EncodeError> {
    let mip_chain = match decided {
        Some(decided) => decided.mip_chain,
        None => normals_of_means(map).encode(normal_encoding(map, first))?,
    };
    let scale = (map.normal_scale != 1.0).then_some(map.normal_scale);
    Ok(EncodedTexture { scale, ..EncodedTexture::new(Content::Normal, mip_chain) })
}

/// Makes the texture of the lobes that the pyramid profile adds K to, without levels finer than `first`.
pub fn base_roughness_texture(
    map: &MapOffsets<'_>,
    roughening: &Roughening<'_>,
    first: usize,
) -> Result<EncodedTexture, EncodeError> {
    let encoding = Encoding::of(map.settings, 3).starting_at(first).with_orm_metric();
    Ok(EncodedTexture::new(Content::BaseRoughness, BaseRoughnessTexture(roughening).encode(encoding)?))
}

/// Makes the roughness texture of a layer and, under the anisotropic model, its anisotropy texture.
pub fn lobe_textures(
    map: &MapOffsets<'_>,
    roughening: &Roughening<'_>,
    model: &LayerModel,
) -> Result<Vec<EncodedTexture>, EncodeError> {
    let encoding = Encoding::of(map.settings, 3).starting_at(model.first);
    let texture = |content, mip_chain| EncodedTexture {
        model: model.model,
        lobe_errors: model.lobe_errors(),
        ..EncodedTexture::new(content, mip_chain)
    };
    let roughness = RoughnessTexture::new(roughening, model.model).encode(encoding.with_orm_metric())?;
    let mut textures = vec![texture(Content::Roughness, roughness)];
    if model.model == Model::Anisotropic {
        textures.push(texture(Content::Anisotropy, AnisotropyTexture::new(roughening).encode(encoding)?));
    }
    Ok(textures)
}
