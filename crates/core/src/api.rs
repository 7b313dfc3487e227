//! The functions that the crate root exports: checked settings in, bytes out, one error type.
//! `roughcast map` shares the functions that read and bake standalone maps.

mod map_provenance;

pub use map_provenance::MapProvenance;

use crate::bake::{self, BakeError, BakedAsset, BaseRoughness, EncodedMap, EncodedTexture, Files, Source};
use crate::bump::{HeightMap, NormalLayout, NormalMap};
use crate::codec::EncodeError;
use crate::decode::{DecodeError, decode, decode_colours};
use crate::gltf::document::{Document, DocumentError};
use crate::image::{DecodeOptions, MapError};
use crate::material::{BumpMap, Range};
use crate::memory::OutOfMemory;
use crate::mip::Wrap;
use crate::note::Note;
use crate::report::{Choice, Content};
use crate::settings::{Model, Settings, SettingsError};

/// Why something cannot be baked. Messages name the material and the texture; callers add the name of the document.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A setting is out of its range, or two settings exclude each other.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The bytes are no glTF 2.0 document.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// The document or the map cannot be baked: a material, an image or a file beside it is missing or damaged.
    #[error(transparent)]
    Bake(#[from] BakeError),
    /// An image cannot be decoded.
    #[error(transparent)]
    Image(#[from] DecodeError),
    /// An image cannot serve as a normal or height map.
    #[error(transparent)]
    Map(#[from] MapError),
    /// A texture cannot be encoded.
    #[error(transparent)]
    Encode(#[from] EncodeError),
    /// There is not enough free memory.
    #[error(transparent)]
    OutOfMemory(#[from] OutOfMemory),
}

/// Bakes every material of a glTF document that has a normal or height map.
///
/// `document` holds the bytes of a .gltf or .glb file, and `stem` is its file name without the extension: the outputs
/// are named after it. `files` reads the files that the document names; a closure from a relative path to bytes is
/// enough. The result holds the new document and new files, whose paths are relative to it. A .glb stays a .glb with
/// everything inside, unless [`Settings::glb`] or [`Settings::gltf`] asks for a .gltf. A document without bumps that
/// keeps its container comes back byte for byte.
///
/// # Errors
/// [`Error`] for the first thing that is wrong with the settings, the document or a file.
pub fn bake_asset(stem: &str, document: &[u8], files: &dyn Files, settings: &Settings) -> Result<BakedAsset, Error> {
    bake_asset_with_progress(stem, document, files, settings, &|_| {})
}

/// Bakes as [`bake_asset`] does, and calls `progress` after each bump map with the share of the work that is done.
///
/// # Errors
/// Those of [`bake_asset`].
pub fn bake_asset_with_progress(
    stem: &str,
    document: &[u8],
    files: &dyn Files,
    settings: &Settings,
    progress: &dyn Fn(f32),
) -> Result<BakedAsset, Error> {
    settings.validate()?;
    settings.target.check_available()?;
    let document = Document::parse(document)?;
    Ok(bake::bake_asset(&Source::new(stem, &document, files), settings, progress)?)
}

/// What a standalone map became.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct BakedMap {
    /// The KTX2 files. The first one is the bump map: normals, or offsets in the pyramid profile.
    pub textures: Vec<BakedTexture>,
    /// What is modelled of the lost bumps.
    pub model: Model,
    /// The candidates for the model, if the surface's own roughness is known.
    pub choice: Option<Choice>,
    /// What is not as exact as it could be, and why.
    pub notes: Vec<Note>,
}

/// A texture that was made from a standalone map.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct BakedTexture {
    /// What the texels are.
    pub content: Content,
    /// Columns of level 0.
    pub width: u32,
    /// Rows of level 0.
    pub height: u32,
    /// The KTX2 file, with all mip levels.
    pub ktx2: Vec<u8>,
    /// What texels of 0 and 1 stand for; only in textures of D and lambda_1.
    pub range: Option<Range>,
    /// What multiplies the slopes of the stored normals; only in textures of offsets.
    pub scale: Option<f32>,
}

/// Bakes one normal or height map without a document.
///
/// Roughness is written only if `base_roughness` is given, since the bake adds the lost bumps to the roughness that the
/// surface has already.
///
/// # Errors
/// [`Error`] if the settings are wrong, or a texture is too large or cannot be encoded.
pub fn bake_map(
    bump_map: &BumpMap,
    base_roughness: Option<&BaseRoughness>,
    settings: &Settings,
) -> Result<BakedMap, Error> {
    let baked = encode_map(bump_map, base_roughness, settings)?;
    let texture = |mut texture: EncodedTexture| {
        let (width, height) = (texture.mip_chain.width, texture.mip_chain.height);
        let ktx2 = texture.mip_chain.take_ktx2(&[])?;
        Ok(BakedTexture { content: texture.content, width, height, ktx2, range: texture.range, scale: texture.scale })
    };
    let textures = baked.textures.into_iter().map(texture).collect::<Result<_, OutOfMemory>>()?;
    Ok(BakedMap { textures, model: baked.model, choice: baked.choice, notes: baked.notes })
}

/// Bakes as [`bake_map`] does, and leaves the making of the files to the caller: `roughcast map` records provenance in
/// them, and holds one at a time.
///
/// # Errors
/// [`Error`] if the settings are wrong, or a texture is too large or cannot be encoded.
pub fn encode_map(
    bump_map: &BumpMap,
    base_roughness: Option<&BaseRoughness>,
    settings: &Settings,
) -> Result<EncodedMap, Error> {
    settings.validate()?;
    settings.target.check_available()?;
    Ok(bake::bake_map(bump_map, base_roughness, settings)?)
}

/// Reads an image file as a normal map in tangent space. Green points up (OpenGL convention) unless `is_green_down`.
///
/// # Errors
/// [`Error::Image`] if the bytes are no image, and [`Error::Map`] if the image is no normal map.
pub fn read_normal_map(bytes: &[u8], layout: NormalLayout, is_green_down: bool) -> Result<BumpMap, Error> {
    read_bump_map(bytes, &BumpTexels::Normals { layout, is_green_down }, &decode_options())
}

/// Reads an image file as a height map. `scale` is the difference between heights of 0 and 1, in widths of the map;
/// `wrap` is the wrap mode of the sampler, across and down.
///
/// # Errors
/// [`Error::Image`] if the bytes are no image, and [`Error::Map`] if the image is no height map.
pub fn read_height_map(bytes: &[u8], scale: f32, wrap: [Wrap; 2]) -> Result<BumpMap, Error> {
    read_bump_map(bytes, &BumpTexels::Heights { scale, wrap }, &decode_options())
}

/// Reads an image file as the roughness that a surface has by itself, in green or grey. `factor` multiplies it.
///
/// # Errors
/// [`Error::Image`] if the bytes are no image, and [`Error::Map`] if texels are NaN or infinite.
pub fn read_roughness_map(bytes: &[u8], factor: f32) -> Result<BaseRoughness, Error> {
    read_base_roughness(bytes, factor, &decode_options())
}

/// What the texels of a bump map are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BumpTexels {
    /// Normals in tangent space.
    Normals {
        /// The channels that hold the normal.
        layout: NormalLayout,
        /// Whether green points down the image (DirectX convention).
        is_green_down: bool,
    },
    /// Heights.
    Heights {
        /// The difference between heights of 0 and 1, in widths of the map.
        scale: f32,
        /// The wrap mode of the sampler, across and down.
        wrap: [Wrap; 2],
    },
}

/// Reads an image file as a bump map, within the limits of `options`.
///
/// # Errors
/// [`Error::Image`] if the bytes are no image, and [`Error::Map`] if the image is no such map.
pub fn read_bump_map(bytes: &[u8], texels: &BumpTexels, options: &DecodeOptions) -> Result<BumpMap, Error> {
    let image = decode(bytes, options)?;
    Ok(match *texels {
        BumpTexels::Normals { layout, is_green_down } => {
            BumpMap::Normals(NormalMap::new(image, layout, is_green_down)?)
        }
        BumpTexels::Heights { scale, wrap } => {
            let slope = scale * image.width as f32;
            BumpMap::Heights { map: HeightMap::new(image)?, slope_per_step: [slope; 2], wrap }
        }
    })
}

/// Reads as [`read_roughness_map`] does, within the limits of `options`.
///
/// # Errors
/// Those of [`read_roughness_map`].
pub fn read_base_roughness(bytes: &[u8], factor: f32, options: &DecodeOptions) -> Result<BaseRoughness, Error> {
    let image = decode_colours(bytes, options)?.into_finite_colours()?;
    Ok(BaseRoughness { image: Some(image), factor })
}

/// Returns options with the default limit on the size of images.
fn decode_options() -> DecodeOptions {
    DecodeOptions { max_pixels: Settings::default().max_texels, ..DecodeOptions::default() }
}
