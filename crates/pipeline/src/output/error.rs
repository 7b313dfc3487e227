//! Why a file cannot be written.

use std::fmt::{self, Display};
use std::io;
use std::path::PathBuf;

/// Why the system refuses to write, and what to do.
struct Unwritable<'a>(&'a io::Error);

impl Display for Unwritable<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        use io::ErrorKind as Kind;
        match self.0.kind() {
            Kind::PermissionDenied => f.write_str("no permission to write there; choose another output folder"),
            Kind::AlreadyExists | Kind::NotADirectory => {
                f.write_str("a file in place of its folder; choose another output folder")
            }
            Kind::IsADirectory => f.write_str("a folder of that name; choose another name"),
            Kind::StorageFull | Kind::QuotaExceeded | Kind::FileTooLarge => write!(f, "{}; free space", self.0),
            _ => write!(f, "{}; choose another output folder", self.0),
        }
    }
}

/// Why a file cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum PublishError {
    /// The file system refuses to write.
    #[error("expected to write {}, found: {}", path.display(), Unwritable(error))]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's error.
        error: io::Error,
    },
    /// A file to be copied cannot be read.
    #[error(
        "expected a readable file at {}, found: {error}; restore the file, which the document refers to",
        path.display()
    )]
    Copy {
        /// The file.
        path: PathBuf,
        /// The system's error.
        error: io::Error,
    },
    /// Two assets of one run need different files at the same path.
    #[error(
        "expected {} to be free, found {} there, which another asset of this run needs; bake them into \
         different folders",
        path.display(), other.display()
    )]
    SamePlace {
        /// The output.
        path: PathBuf,
        /// The file that was copied there before.
        other: PathBuf,
    },
    /// Two outputs whose names differ in case only.
    #[error(
        "expected names that differ in more than case, found {} and {}, which are one file on Windows and macOS; rename \
         one of them, or bake them into different folders",
        path.display(), other.display()
    )]
    SameName {
        /// The later output.
        path: PathBuf,
        /// The earlier output.
        other: PathBuf,
    },
    /// An output would overwrite a source.
    #[error(
        "expected an output apart from the sources, found that {} is a source; choose another output with -o",
        path.display()
    )]
    OverSource {
        /// The file.
        path: PathBuf,
    },
    /// A file that the user names would overwrite a source or another output.
    #[error("{}: expected a file of its own, found that it is {found} of this run; name another file", path.display())]
    InUse {
        /// The file.
        path: PathBuf,
        /// What the file is: a source or an output.
        found: &'static str,
    },
    /// A folder of the outputs is a link that leads out of the output folder.
    #[error(
        "expected to write {} inside the output folder, found that {} is a link to {}; remove the link, or choose the \
         folder that it leads to with -o",
        path.display(), link.display(), target.display()
    )]
    Linked {
        /// The file.
        path: PathBuf,
        /// The link.
        link: PathBuf,
        /// Where the link leads.
        target: PathBuf,
    },
    /// An output would be outside of the output folder.
    #[error(
        "expected an output inside the folder {}, found {} outside of it; choose the output folder with -o",
        folder.display(), path.display()
    )]
    Outside {
        /// The file.
        path: PathBuf,
        /// The output folder.
        folder: PathBuf,
    },
    /// The path is a pipe or a device.
    #[error("expected a file or nothing at {}, found a pipe or a device; name another file or folder", path.display())]
    NotAFile {
        /// The path.
        path: PathBuf,
    },
}
