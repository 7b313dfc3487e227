//! The textures, images and samplers of a glTF document.

use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::sync::Arc;

use serde::Deserialize;
use serde_json::Value;

use super::uri::relative_path;
use crate::image::FileFormat;
use crate::mip::{Magnification, Sampler, Wrap};

/// Extensions with which a texture names an image besides its core `source`, most faithful first.
const SOURCE_EXTENSIONS: [&str; 2] = ["EXT_texture_webp", "KHR_texture_basisu"];

/// A reference between objects of a document that cannot be followed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TextureError {
    /// An index beyond the end of its array.
    #[error("expected an index below {count}, found {array}[{index}]; fix the reference or add the object")]
    OutOfRange {
        /// `textures`, `images`, `samplers` or `bufferViews`.
        array: &'static str,
        /// The index.
        index: usize,
        /// Objects in the array.
        count: usize,
    },
    /// A texture without an image.
    #[error(
        "expected texture {texture} to name an image, found no source that can be read; give it a PNG, JPEG, WebP or KTX2"
    )]
    NoSource {
        /// Index into `textures`.
        texture: usize,
    },
    /// An object that glTF 2.0 does not allow.
    #[error("expected {array}[{index}] as glTF 2.0 defines it, found: {reason}; fix it in the file")]
    Shape {
        /// The array.
        array: &'static str,
        /// The index.
        index: usize,
        /// The message of the JSON reader.
        reason: String,
    },
}

/// Where the bytes of an image are.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ImageLocation {
    /// A URI: relative to the document, or `data:`.
    Uri(String),
    /// Index into `bufferViews`.
    BufferView(usize),
}

/// A texture's image and sampler.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureSource {
    /// Index into `images`.
    pub image: usize,
    /// Where the bytes of the image are.
    pub location: Arc<ImageLocation>,
    /// Where the bytes of other forms of the image are. These forms are not read.
    pub other_forms: Vec<Arc<ImageLocation>>,
    /// The name of the image or, without one, of the texture.
    pub name: Option<String>,
    /// Index into `samplers`.
    pub sampler: Option<usize>,
    /// Wrap modes across and down.
    pub wrap: [Wrap; 2],
    /// How the sampler magnifies level 0.
    pub magnification: Magnification,
    /// Whether the sampler reads mip levels.
    pub samples_mips: bool,
}

impl TextureSource {
    /// Returns the modes of the sampler.
    pub fn sampling(&self) -> Sampler {
        Sampler { wrap: self.wrap, magnification: self.magnification }
    }

    /// Returns the part of a file name that identifies the image: the name of its file or, without a file, its own
    /// name.
    pub fn stem(&self) -> String {
        let named = || self.name.as_deref().map(without_extension).filter(|name| !name.is_empty());
        match &*self.location {
            ImageLocation::Uri(uri) if uri.starts_with("data:") => named().unwrap_or("image").to_owned(),
            ImageLocation::Uri(uri) => {
                let path = relative_path(uri).unwrap_or_else(|_| uri.into());
                path.file_stem().map_or_else(|| "image".to_owned(), |stem| stem.to_string_lossy().into_owned())
            }
            ImageLocation::BufferView(view) => named().map_or_else(|| format!("image{view}"), str::to_owned),
        }
    }
}

/// Returns an image's name without the extension of an image file, which some exporters leave in names.
fn without_extension(name: &str) -> &str {
    let extension = Path::new(name).extension().and_then(|e| e.to_str());
    extension
        .filter(|extension| FileFormat::is_extension(extension))
        .map_or(name, |extension| &name[..name.len() - extension.len() - 1])
}

/// The textures of a document. Each texture is read once and shared by all users, together with the URI of its image,
/// which may hold megabytes of data.
pub struct Textures<'r> {
    root: &'r Value,
    by_index: HashMap<usize, Arc<TextureSource>>,
    /// Textures by the address of their image's location, which is unique to the image, and by their sampler.
    by_content: HashMap<(usize, Option<usize>), Arc<TextureSource>>,
    images: HashMap<usize, Arc<ImageLocation>>,
    locations: HashSet<Arc<ImageLocation>>,
}

impl<'r> Textures<'r> {
    /// Returns the textures of `root`, the document's JSON.
    pub fn of(root: &'r Value) -> Self {
        Self {
            root,
            by_index: HashMap::new(),
            by_content: HashMap::new(),
            images: HashMap::new(),
            locations: HashSet::new(),
        }
    }

    /// Reads texture `texture`. The core `source` is preferred, because a second image is a lossy form of the first.
    /// Textures that read one image in the same way share one result.
    ///
    /// # Errors
    /// [`TextureError`] for references that cannot be followed.
    pub fn get(&mut self, texture: usize) -> Result<Arc<TextureSource>, TextureError> {
        if let Some(known) = self.by_index.get(&texture) {
            return Ok(known.clone());
        }
        let source = self.read(texture)?;
        let key = (Arc::as_ptr(&source.location).addr(), source.sampler);
        let shared = self.by_content.entry(key).or_insert_with(|| Arc::new(source)).clone();
        self.by_index.insert(texture, shared.clone());
        Ok(shared)
    }

    fn read(&mut self, texture: usize) -> Result<TextureSource, TextureError> {
        let raw: RawTexture = object(self.root, "textures", texture)?;
        let sources = SOURCE_EXTENSIONS.iter().filter_map(|name| raw.extensions.get(name)?.get("source")?.as_u64());
        let mut images = raw.source.into_iter().chain(sources.map(|i| usize::try_from(i).unwrap_or(usize::MAX)));
        let image = images.next().ok_or(TextureError::NoSource { texture })?;
        let location = self.location(image)?;
        let other_forms = images.filter(|i| *i != image).map(|i| self.location(i)).collect::<Result<_, _>>()?;
        let modes = match raw.sampler {
            None => RawSampler::default(),
            Some(sampler) => object(self.root, "samplers", sampler)?,
        };
        let name = |array: &str, index: usize| self.root.get(array)?.get(index)?.get("name")?.as_str();
        let name = name("images", image).filter(|name| !name.is_empty()).or_else(|| name("textures", texture));
        Ok(TextureSource {
            image,
            location,
            other_forms,
            name: name.map(str::to_owned),
            sampler: raw.sampler,
            wrap: [wrap_mode(modes.wrap_s), wrap_mode(modes.wrap_t)],
            magnification: match modes.mag_filter {
                Some(9728) => Magnification::Nearest,
                _ => Magnification::Linear,
            },
            // The filters NEAREST and LINEAR.
            samples_mips: !matches!(modes.min_filter, Some(9728 | 9729)),
        })
    }

    /// Returns where the bytes of an image are. Images with equal bytes share one location.
    fn location(&mut self, image: usize) -> Result<Arc<ImageLocation>, TextureError> {
        if let Some(known) = self.images.get(&image) {
            return Ok(known.clone());
        }
        let location = Arc::new(image_location(self.root, image)?);
        let shared = self.locations.get(&location).cloned().unwrap_or_else(|| {
            self.locations.insert(location.clone());
            location
        });
        self.images.insert(image, shared.clone());
        Ok(shared)
    }
}

/// Reads texture `texture` of `root`, the document's JSON, as [`Textures::get`] does.
///
/// # Errors
/// [`TextureError`] for references that cannot be followed.
pub fn texture_source(root: &Value, texture: usize) -> Result<Arc<TextureSource>, TextureError> {
    Textures::of(root).get(texture)
}

fn image_location(root: &Value, image: usize) -> Result<ImageLocation, TextureError> {
    let raw: RawImage = object(root, "images", image)?;
    match (raw.uri, raw.buffer_view) {
        (Some(uri), _) => Ok(ImageLocation::Uri(uri)),
        (None, Some(view)) => Ok(ImageLocation::BufferView(view)),
        (None, None) => {
            let reason = "neither uri nor bufferView".to_owned();
            Err(TextureError::Shape { array: "images", index: image, reason })
        }
    }
}

/// Returns element `index` of the document's array `array`.
///
/// # Errors
/// [`TextureError::OutOfRange`] and [`TextureError::Shape`].
fn object<T: for<'a> Deserialize<'a>>(root: &Value, array: &'static str, index: usize) -> Result<T, TextureError> {
    let objects = root.get(array).and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let object = objects.get(index).ok_or(TextureError::OutOfRange { array, index, count: objects.len() })?;
    T::deserialize(object).map_err(|reason| TextureError::Shape { array, index, reason: reason.to_string() })
}

/// Maps glTF's constants, which are WebGL's, to wrap modes. Anything else is the default, repeat.
fn wrap_mode(mode: Option<u32>) -> Wrap {
    match mode {
        Some(33071) => Wrap::Clamp,
        Some(33648) => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}

#[derive(Deserialize)]
struct RawTexture {
    source: Option<usize>,
    sampler: Option<usize>,
    #[serde(default)]
    extensions: Value,
}

#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase")]
struct RawSampler {
    mag_filter: Option<u32>,
    min_filter: Option<u32>,
    wrap_s: Option<u32>,
    wrap_t: Option<u32>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct RawImage {
    uri: Option<String>,
    buffer_view: Option<usize>,
}

#[cfg(test)]
mod tests;
