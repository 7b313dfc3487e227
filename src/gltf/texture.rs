//! The textures, images and samplers of a glTF document.

use serde::Deserialize;
use serde_json::Value;

use crate::bump::Wrap;

/// Extensions through which a texture names an image other than its core `source`, most faithful first.
const SOURCE_EXTENSIONS: [&str; 2] = ["EXT_texture_webp", "KHR_texture_basisu"];

/// A reference between objects of a document that leads nowhere.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
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
    /// A texture without any image.
    #[error(
        "expected texture {texture} to name an image, found no source that can be read; give it a PNG, JPEG, WebP or KTX2"
    )]
    NoSource {
        /// Index into `textures`.
        texture: usize,
    },
    /// An object of the wrong shape.
    #[error("expected {array}[{index}] as glTF 2.0 defines it, found: {reason}; fix it in the file")]
    Shape {
        /// The array.
        array: &'static str,
        /// The index.
        index: usize,
        /// What the reader says.
        reason: String,
    },
}

/// Where the bytes of an image are.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
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
    /// Where its bytes are.
    pub location: ImageLocation,
    /// Where the bytes of its other forms are, which are not read.
    pub other_forms: Vec<ImageLocation>,
    /// Index into `samplers`.
    pub sampler: Option<usize>,
    /// Wrap modes across and down.
    pub wrap: [Wrap; 2],
    /// Whether the sampler reads mips.
    pub samples_mips: bool,
}

impl TextureSource {
    /// Whether both read the same image in the same way.
    pub fn is_same(&self, other: &Self) -> bool {
        self.location == other.location && self.sampler == other.sampler
    }
}

/// Reads texture `texture` of `root`, the document's JSON.
///
/// A core `source` is preferred: where there is a second image, it is a lossy form of the first.
///
/// # Errors
/// [`TextureError`] for references that lead nowhere.
pub fn texture_source(root: &Value, texture: usize) -> Result<TextureSource, TextureError> {
    let raw: RawTexture = object(root, "textures", texture)?;
    let from_extensions = SOURCE_EXTENSIONS.iter().filter_map(|name| raw.extensions.get(name)?.get("source")?.as_u64());
    let mut images = raw.source.into_iter().chain(from_extensions.map(|i| usize::try_from(i).unwrap_or(usize::MAX)));
    let image = images.next().ok_or(TextureError::NoSource { texture })?;
    let location = image_location(root, image)?;
    let other_forms = images.filter(|i| *i != image).map(|i| image_location(root, i)).collect::<Result<_, _>>()?;
    let modes = match raw.sampler {
        None => RawSampler::default(),
        Some(sampler) => object(root, "samplers", sampler)?,
    };
    Ok(TextureSource {
        image,
        location,
        other_forms,
        sampler: raw.sampler,
        wrap: [wrap_mode(modes.wrap_s), wrap_mode(modes.wrap_t)],
        // NEAREST and LINEAR.
        samples_mips: !matches!(modes.min_filter, Some(9728 | 9729)),
    })
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

/// Element `index` of the document's array `array`.
///
/// # Errors
/// [`TextureError::OutOfRange`] and [`TextureError::Shape`].
fn object<T: for<'a> Deserialize<'a>>(root: &Value, array: &'static str, index: usize) -> Result<T, TextureError> {
    let objects = root.get(array).and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let object = objects.get(index).ok_or(TextureError::OutOfRange { array, index, count: objects.len() })?;
    T::deserialize(object).map_err(|reason| TextureError::Shape { array, index, reason: reason.to_string() })
}

/// glTF's (that is WebGL's) constants; anything else is the default, repeat.
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
