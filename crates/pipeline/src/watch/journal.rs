//! Reports what happens to the sink, and remembers what the hook needs.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::io;
use std::path::Path;

use super::event::{Event, EventSink, Name};
use super::hook::Changes;
use super::ledger::Removed;
use crate::run::{Done, Written};

/// The events of a session.
pub struct Journal<'s> {
    sink: &'s mut dyn EventSink,
    /// Whether anything happened since the last `idle` event.
    has_news: bool,
    changes: Changes,
}

impl<'s> Journal<'s> {
    /// Returns a journal that reports to `sink`.
    pub fn new(sink: &'s mut dyn EventSink) -> Self {
        Self { sink, has_news: true, changes: Changes::default() }
    }

    /// Reports an event that the journal need not remember.
    pub fn event(&mut self, event: &Event<'_>) -> io::Result<()> {
        self.sink.event(event)
    }

    /// Reports that the asset `input` was baked in `seconds`.
    pub fn baked(&mut self, input: &str, done: &Done, seconds: f64) -> io::Result<()> {
        self.has_news = true;
        self.changes.outputs.push(done.output.clone());
        self.sink.event(&Event::Baked {
            input,
            output: Name(&done.output),
            status: done.status(None),
            files: done.written.iter().map(|Written { path, .. }| Name(path)).collect(),
            bytes: done.bytes,
            seconds,
            done,
        })
    }

    /// Reports that an asset, or the folder, cannot be baked. The document `kept` of an earlier bake stays.
    pub fn failed(&mut self, input: Option<&str>, error: &str, kept: Option<&Path>) -> io::Result<()> {
        self.has_news = true;
        self.sink.event(&Event::Failed { input, error, kept })
    }

    /// Reports that files were removed.
    pub fn removed(&mut self, removed: &[Removed]) -> io::Result<()> {
        let mut by_asset: BTreeMap<&Path, Vec<&Path>> = BTreeMap::new();
        for Removed { path, asset } in removed {
            by_asset.entry(asset).or_default().push(path);
        }
        for (input, files) in by_asset {
            let files = files.into_iter().map(Name).collect();
            self.sink.event(&Event::Removed { input: Name(input), files })?;
        }
        self.has_news |= !removed.is_empty();
        self.changes.removed.extend(removed.iter().map(|removed| removed.path.clone()));
        Ok(())
    }

    /// Reports that nothing is left to do, if anything happened since the last report.
    pub fn idle(&mut self, (assets, failed): (usize, usize)) -> io::Result<()> {
        if std::mem::take(&mut self.has_news) { self.sink.event(&Event::Idle { assets, failed }) } else { Ok(()) }
    }

    /// Reports something that needs no change.
    pub fn note(&mut self, note: &dyn Display) -> io::Result<()> {
        self.sink.note(note)
    }

    /// Reports a problem that stops nothing.
    pub fn warn(&mut self, warning: &dyn Display) -> io::Result<()> {
        self.sink.warn(warning)
    }

    /// Returns the outputs that changed since the last call, if any did.
    pub fn take_changes(&mut self) -> Option<Changes> {
        let changes = std::mem::take(&mut self.changes);
        (!changes.outputs.is_empty() || !changes.removed.is_empty()).then_some(changes)
    }
}
