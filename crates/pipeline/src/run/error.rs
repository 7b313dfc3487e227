//! Why a job cannot be planned or run, and whether another try may succeed.

use std::io;
use std::path::PathBuf;

use crate::bake::{BakeError, ContainerError, ImageError, SourceError};
use crate::cache::NotRelative;
use crate::codec::EncodeError;
use crate::digest::Digest;
use crate::gltf::document::DocumentError;
use crate::input_file::Unreadable;
use crate::material::GridError;
use crate::memory::OutOfMemory;
use crate::output::PublishError;
use crate::run::transient::{is_transient, is_transient_write};
use crate::settings::SettingsError;

/// Why a job fails. The caller adds the asset's name.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The document cannot be read.
    #[error("expected a readable file, found: {}", Unreadable(.0))]
    Read(io::Error),
    /// The file is no glTF document.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// The bake failed.
    #[error(transparent)]
    Bake(#[from] BakeError),
    /// The outputs cannot be written.
    #[error(transparent)]
    Publish(#[from] PublishError),
    /// There is no memory for the document.
    #[error(transparent)]
    OutOfMemory(#[from] OutOfMemory),
    /// Settings of a plan with values out of range, or that contradict each other.
    #[error(transparent)]
    Value(#[from] SettingsError),
    /// The files make another job than the planned one.
    #[error("expected the job {planned}, found {found} from the same source: {reason}; plan again")]
    NotAsPlanned {
        /// The planned id.
        planned: Digest,
        /// The id that the files have now.
        found: Digest,
        /// What changed.
        reason: String,
    },
    /// A job of a plan whose id is right and whose other members are wrong.
    #[error("expected the {member} that planning makes of the job, found others: the plan was edited; plan again")]
    Edited {
        /// The member of the job.
        member: &'static str,
    },
    /// A path that a plan cannot name.
    #[error(
        "expected a path in UTF-8 for the plan, found {} with a name that is not; rename the file or folder",
        path.display()
    )]
    NotUtf8 {
        /// The file or folder.
        path: PathBuf,
    },
    /// A baked file that is not below the output folder.
    #[error(transparent)]
    NotRelative(#[from] NotRelative),
    /// A file that changed during the bake.
    #[error("expected {} to stay as it is during the bake, found that it changed; bake again", path.display())]
    Changed {
        /// The file.
        path: PathBuf,
    },
    /// A file of a job that is not in its folder, so that the job cannot be run elsewhere.
    #[error("expected {} in the folder of the asset or of its outputs, found it elsewhere; plan again", path.display())]
    NotMovable {
        /// The file.
        path: PathBuf,
    },
    /// A declared output that does not exist after the bake.
    #[error(
        "expected the job to write {}, found nothing there; {}",
        path.display(),
        if *was_written { "bake again, and let nothing else write to that folder" } else { "plan again" }
    )]
    NoOutput {
        /// The file or folder.
        path: PathBuf,
        /// Whether the job wrote the output, so that somebody else removed it.
        was_written: bool,
    },
    /// An output of an asset with the same name in the other container.
    #[error(
        "expected {} free or baked from {source_name}, found it baked from {}; bake into another folder, or remove it first",
        path.display(), found.escape_debug()
    )]
    OtherSource {
        /// The output.
        path: PathBuf,
        /// The source that the output records.
        found: String,
        /// The source of this bake.
        source_name: String,
    },
}

impl RunError {
    /// Returns whether the error is transient, so that another try may succeed: something was busy, full or away, not
    /// missing or wrong.
    pub fn is_transient(&self) -> bool {
        match self {
            Self::Changed { .. } | Self::NoOutput { was_written: true, .. } => true,
            Self::Publish(PublishError::Write { error, .. }) => is_transient_write(error),
            other => other.is_out_of_memory() || other.io().is_some_and(is_transient),
        }
    }

    /// Returns whether memory was short. There may be enough when the job runs alone.
    pub fn is_out_of_memory(&self) -> bool {
        match self {
            Self::OutOfMemory(_)
            | Self::Bake(BakeError::Grid(GridError::OutOfMemory(_)))
            | Self::Bake(BakeError::Encode(EncodeError::OutOfMemory(_))) => true,
            Self::Bake(BakeError::Image(error)) => error.is_out_of_memory(),
            other => other.io().is_some_and(|error| error.kind() == io::ErrorKind::OutOfMemory),
        }
    }

    /// Returns the error of the system, if there is one.
    fn io(&self) -> Option<&io::Error> {
        match self {
            Self::Read(error)
            | Self::Bake(BakeError::Source(SourceError::Read { error, .. }))
            | Self::Bake(BakeError::Container(ContainerError::Source(SourceError::Read { error, .. })))
            | Self::Bake(BakeError::Image(ImageError::Source { error: SourceError::Read { error, .. }, .. })) => {
                Some(error)
            }
            Self::Publish(PublishError::Copy { error, .. } | PublishError::Write { error, .. }) => Some(error),
            _ => None,
        }
    }
}
