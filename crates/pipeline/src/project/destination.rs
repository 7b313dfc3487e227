//! Where outputs go: into a folder, or to a document that `-o` names.

use std::path::{Path, PathBuf};

use crate::gltf::document::Container;

/// The destination of outputs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Destination {
    /// The folder of the outputs.
    pub folder: PathBuf,
    /// The document, if the user names one.
    pub document: Option<NamedDocument>,
}

/// The document that the user names as the output of one asset.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedDocument {
    /// The path, as the user named it.
    pub path: PathBuf,
    /// The file name without extension.
    pub stem: String,
    /// The container that the extension names.
    pub container: Container,
}

/// Why no single input can be baked to the document that `-o` names.
#[derive(Debug, thiserror::Error)]
pub enum DestinationError {
    /// A document that is named as the output of several assets.
    #[error(
        "-o {}: expected one .gltf or .glb file as the input, since -o names one file, found {found}; name one file as the \
         input, or a folder with -o",
        path.display()
    )]
    ForMany {
        /// The document.
        path: PathBuf,
        /// The inputs.
        found: String,
    },
    /// A folder where a document is named.
    #[error(
        "-o {}: expected the name of a file, found a folder; choose another name, or remove the folder",
        path.display()
    )]
    Folder {
        /// The document.
        path: PathBuf,
    },
    /// The name of a file that is no document.
    #[error(
        "-o {}: expected a folder, or a file that ends in .gltf or .glb, found the name of another file; name a folder, or \
         end the name in .gltf or .glb",
        path.display()
    )]
    OtherFile {
        /// The path.
        path: PathBuf,
    },
    /// A document whose name a bake cannot write.
    #[error(
        "-o {}: expected a name in UTF-8 with its extension in lower case, found another one; name it {}",
        path.display(), expected.display()
    )]
    OddName {
        /// The document.
        path: PathBuf,
        /// A better name.
        expected: PathBuf,
    },
}

impl Destination {
    /// Returns the destination `folder`.
    pub fn folder(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), document: None }
    }

    /// Returns what `-o path` means for the inputs `arguments`: a document if the path ends in .gltf or .glb, else a
    /// folder.
    ///
    /// # Errors
    /// [`DestinationError`] if a document is named that no single input can be baked to, or a file that is no document.
    pub fn new(path: &Path, arguments: &[PathBuf]) -> Result<Self, DestinationError> {
        let Some(container) = named_container(path) else {
            let is_other_file = has_extension(path, &OTHER_FILES) && !path.is_dir();
            return match is_other_file {
                true => Err(DestinationError::OtherFile { path: path.to_owned() }),
                false => Ok(Self::folder(path)),
            };
        };
        let path = path.to_owned();
        let found = match arguments {
            [argument] if argument.is_dir() => Some(format!("the folder {}", argument.display())),
            [_] => None,
            _ => Some(format!("{} inputs", arguments.len())),
        };
        if let Some(found) = found {
            return Err(DestinationError::ForMany { path, found });
        }
        if path.is_dir() {
            return Err(DestinationError::Folder { path });
        }
        let name = path.file_name().and_then(|name| name.to_str()).and_then(|name| name.rsplit_once('.'));
        let Some((stem, _)) = name.filter(|(_, extension)| *extension == container.extension()) else {
            return Err(DestinationError::OddName { expected: path.with_extension(container.extension()), path });
        };
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let folder = folder.to_owned();
        Ok(Self { folder, document: Some(NamedDocument { stem: stem.to_owned(), container, path }) })
    }
}

/// Extensions of files that a bake cannot write as its document. No one names a new folder so.
const OTHER_FILES: [&str; 10] = ["bin", "fbx", "jpeg", "jpg", "json", "ktx2", "obj", "png", "usdz", "zip"];

/// Returns the container that the extension of `path` names, if it names one.
pub fn named_container(path: &Path) -> Option<Container> {
    [Container::Gltf, Container::Glb].into_iter().find(|container| has_extension(path, &[container.extension()]))
}

/// Returns whether the extension of `path` is one of `extensions`.
fn has_extension(path: &Path, extensions: &[&str]) -> bool {
    path.extension().is_some_and(|found| extensions.iter().any(|extension| found.eq_ignore_ascii_case(extension)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn destination(path: &str, arguments: &[&str]) -> Result<Destination, String> {
        let arguments: Vec<PathBuf> = arguments.iter().map(PathBuf::from).collect();
        Destination::new(Path::new(path), &arguments).map_err(|error| error.to_string())
    }

    #[test]
    fn only_gltf_and_glb_name_a_document() {
        for folder in ["out", "out/", "a.glb/out", "out.v2", "glb", ".glb"] {
            assert_eq!(destination(folder, &["a.glb", "b"]), Ok(Destination::folder(Path::new(folder))));
        }
        let named = destination("x/out.v2.glb", &["a.gltf"]).unwrap();
        assert_eq!(named.folder, Path::new("x"));
        let document = named.document.unwrap();
        assert_eq!((document.stem.as_str(), document.container), ("out.v2", Container::Glb));
        assert_eq!(destination("out.gltf", &["a.glb"]).unwrap().folder, Path::new("."));
    }

    #[test]
    fn another_file_is_no_destination() {
        let folder = tempfile::tempdir().unwrap();
        let existing = folder.path().join("out.zip");
        std::fs::create_dir(&existing).unwrap();
        assert_eq!(Destination::new(&existing, &[]).unwrap(), Destination::folder(&existing));
        for path in ["out.zip", "x/out.PNG"] {
            let error = destination(path, &["a.glb", "b"]).unwrap_err();
            let expected = format!("-o {path}: expected a folder, or a file that ends in .gltf or .glb");
            assert!(error.starts_with(&expected), "{error}");
        }
    }

    #[test]
    fn a_document_is_the_output_of_one_file() {
        for (arguments, found) in [(&["a.glb", "b.glb"][..], "2 inputs"), (&["."], "the folder .")] {
            let error = destination("out.glb", arguments).unwrap_err();
            assert!(error.contains(found) && error.contains("out.glb"), "{error}");
        }
        assert!(destination("out.GLB", &["a.glb"]).unwrap_err().ends_with("name it out.glb"));
        let folder = tempfile::tempdir().unwrap();
        let named = folder.path().join("out.glb");
        std::fs::create_dir(&named).unwrap();
        assert!(destination(named.to_str().unwrap(), &["a.glb"]).unwrap_err().contains("found a folder"));
    }
}
