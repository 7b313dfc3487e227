//! `roughcast map`: bakes the file of a standalone map into KTX2 files.

use std::io;
use std::path::{Path, PathBuf};

use crate::api::{self, BumpTexels, MapProvenance, encode_map, read_base_roughness, read_bump_map};
use crate::bake::{BaseRoughness, output_stem_of};
use crate::digest::digest;
use crate::image::DecodeOptions;
use crate::input_file::{Unreadable, read_file};
use crate::ktx2::SourceDigest;
use crate::material::notes;
use crate::output::{Guard, PublishError};
use crate::report::{Content, MapReport};
use crate::settings::Settings;

/// A standalone map, and where it is written.
#[derive(Clone, Debug)]
pub struct MapOptions {
    /// The image file.
    pub image: PathBuf,
    /// What the texels of the image are.
    pub texels: BumpTexels,
    /// The layer of an EXR file, or the channel as `layer.channel`.
    pub layer: Option<String>,
    /// The image of the base roughness.
    pub roughness: Option<PathBuf>,
    /// The factor of the base roughness. The base roughness is not known if there is neither an image nor a factor.
    pub roughness_factor: Option<f32>,
    /// The KTX2 file of the bump map. Further textures are written beside it.
    pub output: PathBuf,
    /// The settings of the bake.
    pub settings: Settings,
}

/// What was written for a standalone map.
#[derive(Clone, Debug)]
pub struct WrittenMap {
    /// The files, in the order of the report's textures.
    pub files: Vec<PathBuf>,
    /// The report.
    pub report: MapReport,
}

/// Why the map is not baked.
#[derive(Debug, thiserror::Error)]
pub enum MapFileError {
    /// An image cannot be read.
    #[error("{}: expected a readable file, found: {}", path.display(), Unreadable(error))]
    Read {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        error: io::Error,
    },
    /// An image is damaged, or cannot serve as a map.
    #[error("{}: {error}", path.display())]
    Image {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        error: Box<api::Error>,
    },
    /// The map cannot be baked.
    #[error(transparent)]
    Bake(Box<api::Error>),
    /// A file cannot be written.
    #[error(transparent)]
    Publish(#[from] PublishError),
    /// The output has another extension than .ktx2.
    #[error(
        "-o {}: expected the name of a .ktx2 file, found another extension; name it {}",
        path.display(), path.with_extension("ktx2").display()
    )]
    NotKtx2 {
        /// The output.
        path: PathBuf,
    },
}

impl From<api::Error> for MapFileError {
    fn from(error: api::Error) -> Self {
        Self::Bake(Box::new(error))
    }
}

/// Bakes a standalone map and writes its textures.
///
/// # Errors
/// [`MapFileError`] for the first file that cannot be read, baked or written.
pub fn bake_map_file(options: &MapOptions) -> Result<WrittenMap, MapFileError> {
    let MapOptions { image, roughness, output, settings, .. } = options;
    let mut guard = Guard::default();
    [Some(image), roughness.as_ref()].into_iter().flatten().for_each(|input| guard.add_source(input));
    let first = guard.reserve_file(output)?;
    if !output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ktx2")) {
        return Err(MapFileError::NotKtx2 { path: output.clone() });
    }
    let mut sources = Vec::new();
    let bytes = read_source(image, &mut sources)?;
    let bump_map = read_bump_map(&bytes, &options.texels, &options.decode_options(image, options.layer.clone()))
        .map_err(|error| MapFileError::Image { path: image.clone(), error: error.into() })?;
    let note = notes::of_file(&bytes);
    drop(bytes);
    let base = options.base_roughness(&mut sources)?;
    let mut baked = encode_map(&bump_map, base.as_ref(), settings)?;
    // The decoded images take more memory than the baked levels and are not needed any more.
    drop((bump_map, base));
    baked.notes.extend(note);
    let provenance = MapProvenance {
        texels: options.texels,
        layer: options.layer.as_deref(),
        roughness_factor: options.roughness_factor,
        sources,
    };
    let mut outputs = vec![first];
    for texture in baked.textures.iter().skip(1) {
        outputs.push(guard.reserve_file(&beside(output, texture.content))?);
    }
    let (mut files, mut textures) = (Vec::new(), Vec::new());
    for (mut texture, output) in baked.textures.into_iter().zip(outputs) {
        let keys = provenance.keys(&texture, baked.model, settings);
        let bytes = texture.mip_chain.take_ktx2(&keys).map_err(api::Error::from)?;
        output.write(&bytes)?;
        textures.push(texture.report(output.path().display().to_string(), bytes.len()));
        files.push(output.path().to_owned());
    }
    Ok(WrittenMap { files, report: MapReport::new(baked.model, baked.choice, baked.notes, textures) })
}

impl MapOptions {
    /// Returns how the image at `path` is decoded.
    fn decode_options(&self, path: &Path, layer: Option<String>) -> DecodeOptions {
        let extension = path.extension().map(|extension| extension.to_string_lossy().into_owned());
        DecodeOptions { max_pixels: self.settings.max_texels, layer, extension }
    }

    /// Returns the base roughness, if it is known. Adds the digest of its image to `sources`.
    fn base_roughness(&self, sources: &mut Vec<SourceDigest>) -> Result<Option<BaseRoughness>, MapFileError> {
        let factor = self.roughness_factor.unwrap_or(1.0);
        let Some(path) = &self.roughness else {
            return Ok(self.roughness_factor.map(|factor| BaseRoughness { image: None, factor }));
        };
        let bytes = read_source(path, sources)?;
        let base = read_base_roughness(&bytes, factor, &self.decode_options(path, None));
        base.map(Some).map_err(|error| MapFileError::Image { path: path.clone(), error: error.into() })
    }
}

/// Reads a file and adds its digest to `sources`.
fn read_source(path: &Path, sources: &mut Vec<SourceDigest>) -> Result<Vec<u8>, MapFileError> {
    let bytes = read_file(path).map_err(|error| MapFileError::Read { path: path.to_owned(), error })?;
    let uri = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    sources.push(SourceDigest { uri, blake3: digest(&bytes) });
    Ok(bytes)
}

/// Returns the path of another texture beside `output`: `wool.ktx2` becomes `wool.roughness.ktx2`.
fn beside(output: &Path, content: Content) -> PathBuf {
    let stem = output_stem_of(output);
    output.with_file_name(format!("{stem}.{}.ktx2", content.name()))
}
