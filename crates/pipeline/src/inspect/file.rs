//! `roughcast inspect`: the facts of a file, and the levels of its textures as pictures.

use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde_json::Value;

use super::{DocumentFacts, ExtractError, TextureFacts, extract, inspect_document, inspect_texture};
use crate::bake::{SourceError, output_stem_of};
use crate::check::{Folder, ReferencedFiles};
use crate::gltf::document::{Document, DocumentError};
use crate::gltf::texture::ImageLocation;
use crate::input_file::{Unreadable, read_file};
use crate::ktx2::ReadError;
use crate::output::{Guard, PublishError};
use crate::project::protect;

/// Why a file cannot be inspected.
#[derive(Debug, thiserror::Error)]
pub enum InspectError {
    /// The file cannot be read.
    #[error("expected a readable file, found: {}", Unreadable(.0))]
    Read(#[from] io::Error),
    /// The texture is damaged.
    #[error(transparent)]
    Ktx2(#[from] ReadError),
    /// The document is damaged.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// An image of the document cannot be read.
    #[error("image {image}: {error}")]
    Source {
        /// The name of the image.
        image: String,
        /// What is wrong.
        error: SourceError,
    },
    /// The levels of a texture cannot become pictures.
    #[error("image {image}: {error}")]
    Extract {
        /// The name of the image.
        image: String,
        /// What is wrong.
        error: ExtractError,
    },
    /// A picture cannot be written.
    #[error(transparent)]
    Publish(#[from] PublishError),
}

/// The format version of the JSON.
pub const INSPECT_FORMAT: u32 = 1;

/// The content of a file. `schemas/inspect.schema.json` describes it as JSON.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct InspectReport {
    /// The format version, [`INSPECT_FORMAT`].
    pub format_version: u32,
    /// The facts.
    #[serde(flatten)]
    pub facts: Facts,
    /// The pictures that were written.
    #[serde(skip)]
    pub pictures: Vec<PathBuf>,
}

/// The facts of a file.
#[derive(Debug, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Facts {
    /// Those of a texture.
    Ktx2(Box<TextureFacts>),
    /// Those of a document.
    Gltf(DocumentFacts),
}

/// Inspects `file`. Writes every level of its KTX2 textures to the folder `pictures`, if there is one.
///
/// # Errors
/// [`InspectError`] if the file is damaged, or a picture cannot be made or written.
pub fn inspect_file(file: &Path, pictures: Option<&Path>) -> Result<InspectReport, InspectError> {
    let bytes = read_file(file)?;
    let mut guard = Guard::default();
    guard.add_source(file);
    let is_texture =
        bytes.starts_with(&ktx2::MAGIC) || file.extension().is_some_and(|e| e.eq_ignore_ascii_case("ktx2"));
    let (facts, pictures) = if is_texture {
        let facts = inspect_texture(&bytes)?;
        let write = |folder: &Path| write_levels(&output_stem_of(file), &bytes, folder, &mut guard);
        (Facts::Ktx2(Box::new(facts)), pictures.map(write).transpose()?.unwrap_or_default())
    } else {
        let document = Document::parse(&bytes)?;
        protect(&mut guard, file, &document);
        let root: Value = document.json().value("").map_err(DocumentError::from)?.unwrap_or_default();
        let files = Folder(file.parent().unwrap_or(Path::new("")).to_owned());
        let referred = ReferencedFiles::new(&document, &root, &files, true);
        let facts = inspect_document(&root, &referred)?;
        let write = |folder: &Path| write_textures(&root, &referred, folder, &mut guard);
        (Facts::Gltf(facts), pictures.map(write).transpose()?.unwrap_or_default())
    };
    Ok(InspectReport { format_version: INSPECT_FORMAT, facts, pictures })
}

/// Writes every level of the KTX2 images of a document. Returns the files.
fn write_textures(
    root: &Value,
    referred: &ReferencedFiles<'_>,
    folder: &Path,
    guard: &mut Guard,
) -> Result<Vec<PathBuf>, InspectError> {
    let (mut written, mut taken) = (Vec::new(), BTreeSet::new());
    for (image, location) in images(root) {
        let held = referred.image(&location).map_err(|error| InspectError::Source { image: image.clone(), error })?;
        if held.is_ktx2() {
            let stem = output_stem_of(Path::new(&image));
            // On case-insensitive file systems, names that differ in case only are one file.
            let numbered = |n: u32| if n == 1 { stem.clone() } else { format!("{stem}-{n}") };
            let unique = (1..).map(numbered).find(|name| taken.insert(name.to_lowercase())).unwrap_or_default();
            written.extend(write_levels(&unique, held.as_ktx2(), folder, guard)?);
        }
    }
    Ok(written)
}

/// Returns the images of a document, each with a name: its path, or `image<index>`.
fn images(root: &Value) -> Vec<(String, ImageLocation)> {
    let list = root.get("images").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let image = |(index, image): (usize, &Value)| {
        let uri = image.get("uri").and_then(Value::as_str);
        let view = image.get("bufferView").and_then(Value::as_u64).and_then(|v| usize::try_from(v).ok());
        let path = uri.and_then(|uri| crate::gltf::uri::relative_path(uri).ok());
        let name = path.map_or_else(|| format!("image{index}"), |p| p.to_string_lossy().into_owned());
        let location = uri.map(|uri| ImageLocation::Uri(uri.to_owned())).or(view.map(ImageLocation::BufferView))?;
        Some((name, location))
    };
    list.iter().enumerate().filter_map(image).collect()
}

/// Writes every level of a texture. Returns the files.
fn write_levels(stem: &str, bytes: &[u8], folder: &Path, guard: &mut Guard) -> Result<Vec<PathBuf>, InspectError> {
    let pictures = extract(bytes).map_err(|error| InspectError::Extract { image: stem.to_owned(), error })?;
    let mut written = Vec::with_capacity(pictures.len());
    for picture in pictures {
        let path = guard.reserve_file(&folder.join(format!("{stem}.level{}.{}", picture.level, picture.extension)))?;
        path.write(&picture.bytes)?;
        written.push(path.path().to_owned());
    }
    Ok(written)
}
