//! Why no asset can be selected.

use std::io;
use std::path::PathBuf;

use crate::codec::EncodeError;
use crate::input_file::Unreadable;
use crate::project::destination::DestinationError;
use crate::project::file::{ConfigError, FILE_NAME};
use crate::settings::SettingsError;

/// Why no asset can be selected.
#[derive(Debug, thiserror::Error)]
pub enum SelectionError {
    /// A configuration that cannot be read.
    #[error("{}: expected a readable file, found: {}", path.display(), Unreadable(error))]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's error.
        error: io::Error,
    },
    /// A configuration with wrong content.
    #[error("{}: {error}", path.display())]
    Config {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        error: ConfigError,
    },
    /// Settings that contradict each other.
    #[error(transparent)]
    Value(#[from] SettingsError),
    /// A target that this build does not have.
    #[error(transparent)]
    Encode(#[from] EncodeError),
    /// A configuration that came with assets names an output folder that it may not name.
    #[error(
        "{}: expected `output` below the working folder and in no hidden folder, found {}; if outputs belong there, name \
         the folder with -o",
        config.display(), path.display()
    )]
    OutputElsewhere {
        /// The configuration.
        config: PathBuf,
        /// The folder.
        path: PathBuf,
    },
    /// A document that `-o` names and that no single input can be baked to.
    #[error(transparent)]
    Destination(#[from] DestinationError),
    /// A document whose extension names another container than `--glb`.
    #[error(
        "{}: expected a name that suits --glb={is_glb}, found another extension; leave --glb out or name another document",
        path.display()
    )]
    OtherContainer {
        /// The document.
        path: PathBuf,
        /// The value of `--glb`.
        is_glb: bool,
    },
    /// A configuration that names a document as the output.
    #[error(
        "{}: expected a folder as `output`, found the document {}; name a folder, or the document with -o",
        config.display(), path.display()
    )]
    NamedInConfig {
        /// The configuration.
        config: PathBuf,
        /// The document.
        path: PathBuf,
    },
    /// No output folder.
    #[error("expected an output folder, found none; name it with -o, or as `output` in {FILE_NAME}")]
    NoOutput,
}
