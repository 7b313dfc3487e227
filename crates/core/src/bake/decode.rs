//! Step 3: the images of a group of layers are decoded.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use crate::bake::group::{BumpMapGroup, GroupLayer};
use crate::bake::image_error::ImageError;
use crate::bake::offsets::bump_map_of;
use crate::bake::reader::Reader;
use crate::decode::{DecodeError, decode, decode_colours};
use crate::digest::{Digest, digest};
use crate::gltf::texture::{ImageLocation, TextureSource};
use crate::image::{DecodeOptions, Image};
use crate::ktx2::{Ktx2, PROVENANCE_KEY};
use crate::material::{BumpMap, notes};
use crate::note::Note;

/// A decoder of image bytes: [`decode`] for bumps, [`decode_colours`] for all other textures.
type Decode = fn(&[u8], &DecodeOptions) -> Result<Image, DecodeError>;

/// The images of a document, decoded on demand.
pub struct Images<'a> {
    reader: &'a Reader<'a>,
    max_texels: u64,
    /// BLAKE3 of the bytes of each image that was decoded, for provenance.
    digests: Mutex<BTreeMap<Arc<ImageLocation>, Digest>>,
}

/// The images of a base lobe.
#[derive(Default)]
pub struct BaseImages {
    /// Green is roughness.
    pub roughness: Option<Image>,
    /// Direction and strength.
    pub anisotropy: Option<Image>,
}

impl<'a> Images<'a> {
    /// Returns the images that `reader` reads. None of them may have more than `max_texels` texels.
    pub fn new(reader: &'a Reader<'a>, max_texels: u64) -> Self {
        Self { reader, max_texels, digests: Mutex::default() }
    }

    /// Decodes the bump map of `group` and returns it with notes to the user.
    pub fn bump_map(&self, group: &BumpMapGroup) -> Result<(BumpMap, Vec<Note>), ImageError> {
        let material = group.layers.first().map(|layer| layer.name.clone()).unwrap_or_default();
        let file = self.file(&group.source, &material)?;
        let image = self.decoded(&file, &group.source, &material, decode)?;
        let failed = |error| ImageError::Map { material, texture: describe(&group.source.location), error };
        let bump_map = bump_map_of(image, group.kind).map_err(failed)?;
        Ok((bump_map, notes::of_file(&file).into_iter().collect()))
    }

    /// Decodes the images of the base lobe of `layer`.
    pub fn base(&self, layer: &GroupLayer) -> Result<BaseImages, ImageError> {
        let image = |texture: Option<&TextureSource>| texture.map(|t| self.colours(t, &layer.name)).transpose();
        let [roughness, anisotropy] = layer.base_textures();
        Ok(BaseImages { roughness: image(roughness)?, anisotropy: image(anisotropy)? })
    }

    /// Returns those of `locations` that were decoded, with the digests of their bytes.
    pub fn digests<'l>(
        &self,
        locations: impl IntoIterator<Item = &'l Arc<ImageLocation>>,
    ) -> Vec<(Arc<ImageLocation>, Digest)> {
        let digests = self.digests.lock().unwrap_or_else(PoisonError::into_inner);
        locations.into_iter().filter_map(|l| Some((l.clone(), *digests.get(l)?))).collect()
    }

    /// Decodes the image of `texture`, which `material` uses for a base lobe or its reflectance.
    pub fn colours(&self, texture: &TextureSource, material: &str) -> Result<Image, ImageError> {
        let file = self.file(texture, material)?;
        self.decoded_colours(&file, texture, material)
    }

    /// Decodes the image of `texture`, which `material` uses and the bake does not change. Returns `None` for a KTX2.
    pub fn colours_unless_ktx2(&self, texture: &TextureSource, material: &str) -> Result<Option<Image>, ImageError> {
        let file = self.file(texture, material)?;
        if file.starts_with(&::ktx2::MAGIC) {
            return Ok(None);
        }
        self.decoded_colours(&file, texture, material).map(Some)
    }

    fn decoded_colours(&self, file: &[u8], texture: &TextureSource, material: &str) -> Result<Image, ImageError> {
        let image = self.decoded(file, texture, material, decode_colours)?;
        image.into_finite_colours().map_err(|error| ImageError::Map {
            material: material.to_owned(),
            texture: describe(&texture.location),
            error,
        })
    }

    /// Reads the bytes of an image, which [`Self::decoded`] then hashes.
    fn file(&self, texture: &TextureSource, material: &str) -> Result<Cow<'_, [u8]>, ImageError> {
        self.reader.image_to_hash(&texture.location).map_err(|error| ImageError::Source {
            material: material.to_owned(),
            texture: describe(&texture.location),
            error,
        })
    }

    /// Decodes the bytes of an image and hashes them on another thread: decoders have one thread each.
    fn decoded(
        &self,
        file: &[u8],
        texture: &TextureSource,
        material: &str,
        decode: Decode,
    ) -> Result<Image, ImageError> {
        let decode = || self.decode_unbaked(file, texture, material, decode);
        let (image, digest) = rayon::join(decode, || digest(file));
        self.reader.hashed(&texture.location, digest);
        self.digests.lock().unwrap_or_else(PoisonError::into_inner).insert(texture.location.clone(), digest);
        image
    }

    /// Decodes the bytes of an image, unless the image or another form of it was written by Roughcast.
    fn decode_unbaked(
        &self,
        file: &[u8],
        texture: &TextureSource,
        material: &str,
        decode: Decode,
    ) -> Result<Image, ImageError> {
        let (material, described) = (|| material.to_owned(), || describe(&texture.location));
        // The bake does not need other forms, so a form that cannot be read is no error.
        let form_is_baked = |form: &Arc<ImageLocation>| self.reader.image(form).is_ok_and(|bytes| is_baked(&bytes));
        if is_baked(file) || texture.other_forms.iter().any(form_is_baked) {
            return Err(ImageError::AlreadyBaked { material: material(), texture: described() });
        }
        let extension = match &*texture.location {
            ImageLocation::Uri(uri) if !uri.starts_with("data:") => uri.rsplit_once('.').map(|(_, e)| e.to_owned()),
            _ => None,
        };
        let options = DecodeOptions { max_pixels: self.max_texels, extension, ..Default::default() };
        let failed = |error| ImageError::Decode { material: material(), texture: described(), error };
        decode(file, &options).map_err(failed)
    }
}

fn is_baked(file: &[u8]) -> bool {
    Ktx2::parse(file).is_ok_and(|file| file.key_values().any(|(key, _)| key == PROVENANCE_KEY))
}

/// Returns an image's name for messages and provenance.
pub fn describe(location: &ImageLocation) -> String {
    match location {
        ImageLocation::Uri(uri) if uri.starts_with("data:") => {
            format!("{}...", uri.chars().take(32).collect::<String>())
        }
        ImageLocation::Uri(uri) => uri.clone(),
        ImageLocation::BufferView(view) => format!("bufferViews[{view}]"),
    }
}
