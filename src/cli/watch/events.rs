//! What happens, for people and as JSON lines (`schemas/watch.schema.json`).

use std::collections::BTreeMap;
use std::fmt::Display;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::{Serialize, Serializer};

use crate::cli::report::{Asset, Status};
use crate::run::{Done, Written};
use crate::text::printable;
use crate::watch::Removed;

/// A line of `--json`.
#[derive(Debug, Serialize)]
#[serde(tag = "event", rename_all = "camelCase", rename_all_fields = "camelCase")]
pub enum Event<'e> {
    /// From now on nothing is missed.
    Started {
        /// Of the tool.
        version: &'static str,
        /// The watched folder.
        folder: Name<'e>,
        /// The output folder.
        output: Name<'e>,
        /// Milliseconds between two looks, where the system does not tell of changes.
        #[serde(skip_serializing_if = "Option::is_none")]
        poll: Option<u64>,
    },
    /// An asset's outputs are written.
    Baked {
        /// The source.
        input: &'e str,
        /// The document.
        output: Name<'e>,
        /// As in the report of `bake`.
        status: Status,
        /// All files of the asset, the document last.
        files: Vec<Name<'e>>,
        /// Their size.
        bytes: u64,
        /// From reading to writing.
        seconds: f64,
    },
    /// An asset, or the folder, cannot be baked as it is.
    Failed {
        /// The source, if it is one.
        #[serde(skip_serializing_if = "Option::is_none")]
        input: Option<&'e str>,
        /// What is wrong.
        error: &'e str,
        /// The document of its last good bake, which stays with its files.
        #[serde(skip_serializing_if = "Option::is_none")]
        kept: Option<&'e Path>,
    },
    /// Outputs that no asset has any more are gone.
    Removed {
        /// The source that had them.
        input: Name<'e>,
        /// The files.
        files: Vec<Name<'e>>,
    },
    /// The outputs are those of a bake of the folder as it is, beside the last good ones of assets that cannot be baked.
    Idle {
        /// Number of assets.
        assets: usize,
        /// Of those, the ones that cannot be baked.
        failed: usize,
    },
}

/// A path as it is shown: what is not UTF-8 in it is replaced, as in the report of `bake`, since no event may fail.
#[derive(Clone, Copy, Debug)]
pub struct Name<'e>(pub &'e Path);

impl Serialize for Name<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&self.0.display())
    }
}

/// Outputs that changed.
#[derive(Debug, Default)]
pub struct Changes {
    /// Documents that were written.
    pub outputs: Vec<PathBuf>,
    /// Files that were removed.
    pub removed: Vec<PathBuf>,
}

/// Tells what happens.
pub struct EventWriter<'w> {
    out: &'w mut dyn Write,
    err: &'w mut dyn Write,
    is_json: bool,
    is_quiet: bool,
    has_news: bool,
    changes: Changes,
}

impl<'w> EventWriter<'w> {
    /// Results go to `out`, as JSON or unless `is_quiet`; complaints to `err`.
    pub fn new(out: &'w mut dyn Write, err: &'w mut dyn Write, is_json: bool, is_quiet: bool) -> Self {
        Self { out, err, is_json, is_quiet, has_news: true, changes: Changes::default() }
    }

    /// Tells of `event` on a line of its own, if lines are asked for.
    pub fn write(&mut self, event: &Event<'_>) -> io::Result<()> {
        if self.is_json {
            serde_json::to_writer(&mut self.out, event)?;
            self.out.write_all(b"\n")?;
            return self.out.flush();
        }
        match event {
            _ if self.is_quiet => Ok(()),
            Event::Started { folder, output, .. } => {
                let (folder, output) = (folder.0.display().to_string(), output.0.display().to_string());
                let (folder, output) = (printable(&folder), printable(&output));
                writeln!(self.out, "watching {folder}, baking to {output}; Ctrl-C ends")
            }
            Event::Removed { input, files } => {
                let input = input.0.display().to_string();
                writeln!(self.out, "removed {}: {} file(s) of it", printable(&input), files.len())
            }
            _ => Ok(()),
        }?;
        self.out.flush()
    }

    /// An asset was baked in `seconds`.
    pub fn baked(&mut self, name: String, done: &Done, seconds: f64) -> io::Result<()> {
        self.has_news = true;
        self.changes.outputs.push(done.output.clone());
        if !self.is_json && !self.is_quiet {
            self.out.write_all(Asset::done(name, None, done, None, seconds, None).summary().as_bytes())?;
            return self.out.flush();
        }
        let files = done.written.iter().map(|Written { path, .. }| Name(path)).collect();
        let status = Status::of(done, None);
        self.write(&Event::Baked {
            input: &name,
            output: Name(&done.output),
            status,
            files,
            bytes: done.bytes,
            seconds,
        })
    }

    /// An asset, or everything, cannot be baked; the document `kept` of an earlier bake stays.
    pub fn failed(&mut self, input: Option<&str>, error: &str, kept: Option<&Path>) -> io::Result<()> {
        self.has_news = true;
        let stays = kept.map_or_else(String::new, |kept| format!("; {} stays as it was last baked", kept.display()));
        match input {
            Some(input) => writeln!(self.err, "error: {input}: {error}{stays}")?,
            None => writeln!(self.err, "error: {error}{stays}")?,
        }
        self.write(&Event::Failed { input, error, kept })
    }

    /// Files were removed.
    pub fn removed(&mut self, removed: &[Removed]) -> io::Result<()> {
        let mut by_asset: BTreeMap<&Path, Vec<&Path>> = BTreeMap::new();
        for Removed { path, asset } in removed {
            by_asset.entry(asset).or_default().push(path);
        }
        for (input, files) in by_asset {
            let files = files.into_iter().map(Name).collect();
            self.write(&Event::Removed { input: Name(input), files })?;
        }
        self.has_news |= !removed.is_empty();
        self.changes.removed.extend(removed.iter().map(|removed| removed.path.clone()));
        Ok(())
    }

    /// Nothing is left to do, if there was anything.
    pub fn idle(&mut self, (assets, failed): (usize, usize)) -> io::Result<()> {
        if std::mem::take(&mut self.has_news) { self.write(&Event::Idle { assets, failed }) } else { Ok(()) }
    }

    /// Tells a person what need not be changed, unless errors only are asked for.
    pub fn note(&mut self, note: &dyn Display) -> io::Result<()> {
        if self.is_quiet { Ok(()) } else { writeln!(self.err, "note: {note}") }
    }

    /// Complains of what does not stop anything.
    pub fn warn(&mut self, warning: &dyn Display) -> io::Result<()> {
        writeln!(self.err, "warning: {warning}")
    }

    /// What changed since the last time, if anything.
    pub fn take_changes(&mut self) -> Option<Changes> {
        let changes = std::mem::take(&mut self.changes);
        (!changes.outputs.is_empty() || !changes.removed.is_empty()).then_some(changes)
    }
}
