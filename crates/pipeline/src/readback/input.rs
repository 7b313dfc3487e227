//! The input of pictures and charts: an asset, a standalone map as the material of a new asset, or waves as a height
//! map.

use std::io;
use std::path::{Path, PathBuf};

use serde_json::json;

use super::error::ReadBackError;
use crate::bake::{Source, output_stem_of};
use crate::gltf::document::Document;
use crate::gltf::uri::encode_path;
use crate::image::{Image, Samples};
use crate::input_file::read_file;
use crate::inspect::encode_exr;
use crate::output::Guard;
use crate::project::protect;
use crate::render::{SceneName, waves};
use crate::settings::Settings;

/// Texels of the waves along each side.
const WAVES: u32 = 512;

/// An input in memory.
pub enum Input {
    /// A glTF document, and the folder of its files.
    Asset {
        /// The document.
        document: Box<Document>,
        /// Its folder.
        folder: PathBuf,
        /// Its name.
        stem: String,
    },
    /// An image file.
    Map {
        /// Its bytes.
        bytes: Vec<u8>,
        /// Its file name.
        name: String,
        /// What the texels are.
        kind: MapKind,
    },
}

/// What the texels of an image are.
#[derive(Clone, Copy)]
pub enum MapKind {
    /// Normals.
    Normals,
    /// Heights, and their scale in widths of the map.
    Heights(f32),
    /// The waves, whose height depends on the scene.
    Waves,
}

impl Input {
    /// Makes the waves.
    ///
    /// # Errors
    /// [`ReadBackError::Waves`] if they cannot be encoded.
    pub fn waves() -> Result<Self, ReadBackError> {
        let samples = Samples::F32(waves(WAVES));
        let image = Image { width: WAVES, height: WAVES, channels: 1, samples };
        let bytes = encode_exr(image).map_err(ReadBackError::Waves)?;
        Ok(Self::Map { bytes, name: "waves.exr".to_owned(), kind: MapKind::Waves })
    }

    /// Reads the file at `path`. An image holds heights if there is a `height_scale`.
    ///
    /// # Errors
    /// [`ReadBackError::Read`] and [`ReadBackError::Document`].
    pub fn read(path: &Path, height_scale: Option<f32>) -> Result<Self, ReadBackError> {
        let bytes = read_file(path).map_err(ReadBackError::Read)?;
        let extension = path.extension().unwrap_or_default();
        if ["gltf", "glb"].iter().any(|e| extension.eq_ignore_ascii_case(e)) {
            let folder = path.parent().unwrap_or(Path::new("")).to_owned();
            return Ok(Self::Asset {
                document: Box::new(Document::parse(&bytes)?),
                folder,
                stem: output_stem_of(path),
            });
        }
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let kind = height_scale.map_or(MapKind::Normals, MapKind::Heights);
        Ok(Self::Map { bytes, name, kind })
    }

    /// Returns a guard that keeps the input, which was read from `path`, and its files from being overwritten.
    pub fn guard(&self, path: Option<&Path>) -> Guard {
        let mut guard = Guard::default();
        path.iter().for_each(|path| self.protect(&mut guard, path));
        guard
    }

    /// Makes `guard` keep the input, which was read from `path`, and its files from being overwritten.
    pub fn protect(&self, guard: &mut Guard, path: &Path) {
        match self {
            Self::Asset { document, .. } => protect(guard, path, document),
            Self::Map { .. } => guard.add_source(path),
        }
    }

    /// Returns `settings` as a bake of the input has them: only documents have a scale of normals.
    pub fn settings(&self, settings: Settings) -> Settings {
        match self {
            Self::Asset { .. } => settings,
            Self::Map { .. } => settings.with_scale_normals(false),
        }
    }

    /// Passes the document to `then`. A standalone map becomes the material of a new document, with `roughness`, else
    /// the roughness that suits `scene`.
    ///
    /// # Errors
    /// The errors of `then`, and [`ReadBackError::Document`].
    pub fn with_source<T, E: From<ReadBackError>>(
        &self,
        scene: SceneName,
        roughness: Option<f32>,
        then: impl FnOnce(&Source<'_>) -> Result<T, E>,
    ) -> Result<T, E> {
        match self {
            Self::Asset { document, folder, stem } => {
                let read = |path: &Path| read_file(&folder.join(path));
                then(&Source::new(stem, document, &read))
            }
            Self::Map { bytes, name, kind } => {
                let stem = output_stem_of(Path::new(name));
                let texture = json!({ "index": 0 });
                let mut material = json!({
                    "name": stem,
                    "pbrMetallicRoughness": { "roughnessFactor": roughness.unwrap_or(scene.roughness()) },
                });
                let height_scale = match kind {
                    MapKind::Normals => None,
                    MapKind::Heights(scale) => Some(*scale),
                    MapKind::Waves => Some(scene.wave_height()),
                };
                match height_scale {
                    None => material["normalTexture"] = texture,
                    Some(scale) => {
                        let texture = json!({ "index": 0, "scale": scale });
                        material["extras"] = json!({ "roughcast": { "heightTexture": texture } });
                    }
                }
                let asset = json!({
                    "asset": { "version": "2.0" },
                    "images": [{ "uri": encode_path(name) }],
                    "textures": [{ "source": 0 }],
                    "materials": [material],
                });
                let document = Document::parse(asset.to_string().as_bytes()).map_err(ReadBackError::from)?;
                let read = |path: &Path| {
                    if path == Path::new(name) { Ok(bytes.clone()) } else { Err(io::ErrorKind::NotFound.into()) }
                };
                then(&Source::new("", &document, &read))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bakes_of_a_map_leave_the_scale_of_normals_alone() {
        let waves = Input::waves().expect("waves");
        let asset = Input::Asset {
            document: Box::new(Document::parse(b"{}").expect("a document")),
            folder: PathBuf::new(),
            stem: String::new(),
        };
        for asked in [None, Some(true), Some(false)] {
            let mut settings = Settings::default();
            settings.scale_normals = asked;
            assert_eq!(waves.settings(settings).scale_normals, Some(false));
            assert_eq!(asset.settings(settings), settings);
        }
    }
}
