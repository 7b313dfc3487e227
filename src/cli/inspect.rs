//! `roughcast inspect`.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde_json::Value;

use super::terminal::outcome::Outcome;
use crate::bake::{SourceError, output_stem_of};
use crate::check::{Folder, ReferencedFiles};
use crate::gltf::document::{Document, DocumentError};
use crate::gltf::texture::ImageLocation;
use crate::input_file::read_file;
use crate::inspect::{
    DocumentFacts, ExtractError, TextureFacts, document_text, extract, inspect_document, inspect_texture, texture_text,
};
use crate::ktx2::ReadError;
use crate::output::{Guard, PublishError};
use crate::project::protect;
use crate::text::printable;

/// Print the content of a KTX2 or glTF file: levels, formats, ranges, provenance.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  roughcast inspect baked/helmet.gltf --extract levels")]
pub struct Args {
    /// .ktx2, .gltf or .glb.
    file: PathBuf,
    /// Print JSON (schemas/inspect.schema.json).
    #[arg(long)]
    json: bool,
    /// Write every level of every KTX2 texture as PNG, or EXR where it holds floats: NAME.level0.png and so on.
    #[arg(long, value_name = "DIR")]
    extract: Option<PathBuf>,
}

/// Why a file cannot be inspected.
#[derive(Debug, thiserror::Error)]
enum InspectError {
    #[error("expected a readable file, found: {0}; check the path")]
    Read(#[from] io::Error),
    #[error(transparent)]
    Ktx2(#[from] ReadError),
    #[error(transparent)]
    Document(#[from] DocumentError),
    #[error("image {image}: {error}")]
    Source { image: String, error: SourceError },
    #[error("image {image}: {error}")]
    Extract { image: String, error: ExtractError },
    #[error(transparent)]
    Publish(#[from] PublishError),
}

/// The format version of the JSON.
const INSPECT_FORMAT: u32 = 1;

/// The content of a file, as JSON.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct FactsFile<'f> {
    format_version: u32,
    #[serde(flatten)]
    facts: &'f Facts,
}

/// The content of a file.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum Facts {
    Ktx2(Box<TextureFacts>),
    Gltf(DocumentFacts),
}

/// Inspects the file and prints its content.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &Args, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    match inspect(args) {
        Err(error) => {
            let line = format!("error: {}: {error}", args.file.display());
            writeln!(err, "{}", printable(&line))?;
            Ok(Outcome::Failed)
        }
        Ok((facts, written)) => {
            let name = args.file.display().to_string();
            if args.json {
                let file = FactsFile { format_version: INSPECT_FORMAT, facts: &facts };
                writeln!(out, "{}", serde_json::to_string_pretty(&file).map_err(io::Error::other)?)?;
            } else {
                let text = match &facts {
                    Facts::Ktx2(facts) => texture_text(&name, facts),
                    Facts::Gltf(facts) => document_text(&name, facts),
                };
                out.write_all(text.as_bytes())?;
                for path in written {
                    writeln!(out, "wrote {}", printable(&path.display().to_string()))?;
                }
            }
            Ok(Outcome::Done)
        }
    }
}

fn inspect(args: &Args) -> Result<(Facts, Vec<PathBuf>), InspectError> {
    let bytes = read_file(&args.file)?;
    let mut guard = Guard::default();
    guard.add_source(&args.file);
    if bytes.starts_with(&ktx2::MAGIC) || args.file.extension().is_some_and(|e| e.eq_ignore_ascii_case("ktx2")) {
        let facts = inspect_texture(&bytes)?;
        let written = match &args.extract {
            Some(folder) => write_levels(&output_stem_of(&args.file), &bytes, folder, &mut guard)?,
            None => Vec::new(),
        };
        return Ok((Facts::Ktx2(Box::new(facts)), written));
    }
    let document = Document::parse(&bytes)?;
    let root: Value = document.json().value("").map_err(DocumentError::from)?.unwrap_or_default();
    let folder = args.file.parent().unwrap_or(Path::new(""));
    let files = Folder(folder.to_owned());
    let referred = ReferencedFiles::new(&document, &root, &files, true);
    let facts = inspect_document(&root, &referred)?;
    let mut written = Vec::new();
    if let Some(output) = &args.extract {
        let images = images(&root);
        protect(&mut guard, &args.file, &document);
        let mut taken = BTreeSet::new();
        for (image, location) in images {
            let held =
                referred.image(&location).map_err(|error| InspectError::Source { image: image.clone(), error })?;
            if held.is_ktx2() {
                let stem = output_stem_of(Path::new(&image));
                // On case-insensitive file systems, names that differ in case only are one file.
                let numbered = |n: u32| if n == 1 { stem.clone() } else { format!("{stem}-{n}") };
                let unique = (1..).map(numbered).find(|name| taken.insert(name.to_lowercase())).unwrap_or_default();
                written.extend(write_levels(&unique, held.as_ktx2(), output, &mut guard)?);
            }
        }
    }
    Ok((Facts::Gltf(facts), written))
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
