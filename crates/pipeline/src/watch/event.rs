//! The events of watching (`schemas/watch.schema.json`).

use std::fmt::Display;
use std::io;
use std::path::Path;

use serde::{Serialize, Serializer};

use crate::report::Status;
use crate::run::Done;

/// The format version of the events. The first event carries it.
pub const WATCH_FORMAT: u32 = 1;

/// An event of watching, serialised as one JSON line.
#[derive(Debug, Serialize)]
#[serde(tag = "event", rename_all = "camelCase", rename_all_fields = "camelCase")]
pub enum Event<'e> {
    /// From now on no change is missed.
    Started {
        /// The format version, [`WATCH_FORMAT`].
        format_version: u32,
        /// The version of the tool.
        version: &'static str,
        /// The watched folder.
        folder: Name<'e>,
        /// The output folder.
        output: Name<'e>,
        /// Milliseconds between two looks, where the system reports no changes.
        #[serde(skip_serializing_if = "Option::is_none")]
        poll: Option<u64>,
    },
    /// The outputs of an asset are written.
    Baked {
        /// The source.
        input: &'e str,
        /// The document.
        output: Name<'e>,
        /// The status, as in the report of `bake`.
        status: Status,
        /// All files of the asset, the document last.
        files: Vec<Name<'e>>,
        /// Bytes of the files.
        bytes: u64,
        /// Seconds from reading to writing.
        seconds: f64,
        /// What the job did, for a summary.
        #[serde(skip)]
        done: &'e Done,
    },
    /// An asset, or the folder, cannot be baked as it is.
    Failed {
        /// The source; `None` for the folder.
        #[serde(skip_serializing_if = "Option::is_none")]
        input: Option<&'e str>,
        /// What is wrong.
        error: &'e str,
        /// The document of the last successful bake, which stays with its files.
        #[serde(skip_serializing_if = "Option::is_none")]
        kept: Option<&'e Path>,
    },
    /// Outputs that no asset has any more were removed.
    Removed {
        /// The source that had the outputs.
        input: Name<'e>,
        /// The files.
        files: Vec<Name<'e>>,
    },
    /// Nothing is left to do. The outputs are those of a bake of the folder as it is, beside the outputs of the last
    /// successful bake of assets that cannot be baked.
    Idle {
        /// Number of assets.
        assets: usize,
        /// Number of assets that cannot be baked.
        failed: usize,
    },
}

/// A path in an event. Bytes that are not UTF-8 are replaced, as in the report of `bake`, since no event may fail.
#[derive(Clone, Copy, Debug)]
pub struct Name<'e>(pub &'e Path);

impl Serialize for Name<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&self.0.display())
    }
}

/// Receives what happens. An error of the sink ends watching.
pub trait EventSink {
    /// Reports an event.
    ///
    /// # Errors
    /// When the event cannot be written.
    fn event(&mut self, event: &Event<'_>) -> io::Result<()>;

    /// Reports something that needs no change.
    ///
    /// # Errors
    /// When the note cannot be written.
    fn note(&mut self, note: &dyn Display) -> io::Result<()>;

    /// Reports a problem that stops nothing.
    ///
    /// # Errors
    /// When the warning cannot be written.
    fn warn(&mut self, warning: &dyn Display) -> io::Result<()>;
}
