//! `roughcast watch`.

use std::fmt::Display;
use std::io::{self, Write};
use std::path::PathBuf;
use std::slice;
use std::time::Duration;

use super::options::cache::CacheOptions;
use super::options::selection::SelectionOptions;
use super::terminal::outcome::Outcome;
use super::terminal::summary::{notes_to_act_on, summary};
use crate::cache::CacheError;
use crate::project::{Selection, SelectionError, named_container};
use crate::text::printable;
use crate::watch::{Event, EventSink, Hook, WatchOptions, Watcher};

/// Bake a folder of glTF assets, and bake again what changes.
///
/// The outputs are always those of a bake of the folder as it is. They change with the glTF files, with their images
/// and buffers and with roughcast.toml, and are removed when their asset is removed. If an asset cannot be baked, the
/// outputs of its last successful bake stay. Ctrl-C ends watching when the asset at work is done.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  roughcast watch assets -o baked --on-change 'touch reload.txt'")]
pub struct Args {
    /// The folder, which need not exist yet.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Print what happens as JSON, one object per line (docs/pipeline.md).
    #[arg(long)]
    json: bool,
    /// Print errors only.
    #[arg(short, long, conflicts_with = "json")]
    quiet: bool,
    /// Print all notes, not only those that ask for something.
    #[arg(short, long, conflicts_with_all = ["quiet", "json"])]
    verbose: bool,
    /// Run a command of the shell after outputs changed. ROUGHCAST_OUTPUTS has the documents that were written,
    /// ROUGHCAST_REMOVED the files that were removed, one per line.
    #[arg(long, value_name = "COMMAND")]
    on_change: Option<String>,
    /// Look at all files every so many milliseconds, where the system has no events (network drives, some containers).
    #[arg(long, value_name = "MS", num_args = 0..=1, require_equals = true, default_missing_value = "1000",
        value_parser = clap::value_parser!(u64).range(10..))]
    poll: Option<u64>,
    /// Take a file for written when it has not changed for so many milliseconds.
    #[arg(long, value_name = "MS", default_value_t = 50)]
    settle: u64,
    #[command(flatten)]
    cache: CacheOptions,
    #[command(flatten)]
    selection: SelectionOptions,
}

/// Why nothing is watched.
#[derive(Debug, thiserror::Error)]
enum WatchCommandError {
    #[error("{}: expected a folder, found a file; bake it with `roughcast bake`", path.display())]
    File { path: PathBuf },
    #[error(
        "-o {}: expected a folder, found the name of a document, of which a folder has many; name a folder",
        path.display()
    )]
    Named { path: PathBuf },
    #[error(transparent)]
    Selection(#[from] SelectionError),
    #[error(transparent)]
    Cache(#[from] CacheError),
}

/// Watches until the user stops it.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &Args, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    let options = match args.options() {
        Ok(options) => options,
        Err(reason) => {
            writeln!(err, "error: {reason}")?;
            return Ok(Outcome::Usage);
        }
    };
    let watcher = Watcher::new(options);
    let stop = watcher.stop();
    // Whoever asks for the second time does not want to wait. Shells start background jobs with interrupts ignored, but
    // the handler also runs for a signal that somebody sends.
    let _ = ctrlc::set_handler(move || {
        if stop.request() {
            std::process::exit(130);
        }
    });
    let mut printer = EventPrinter { out, err, is_json: args.json, is_quiet: args.quiet, is_verbose: args.verbose };
    watcher.run(&mut printer).map(|()| Outcome::Done)
}

impl Args {
    fn options(&self) -> Result<WatchOptions, WatchCommandError> {
        let folder = &self.folder;
        if folder.exists() && !folder.is_dir() {
            return Err(WatchCommandError::File { path: folder.clone() });
        }
        let selection = self.selection.selection();
        if let Some(path) = selection.output.as_ref().filter(|output| named_container(output).is_some()) {
            return Err(WatchCommandError::Named { path: path.clone() });
        }
        let output = self.output(&selection)?;
        Ok(WatchOptions {
            folder: folder.clone(),
            selection,
            output,
            cache: self.cache.open()?,
            cache_folder: self.cache.folder().map(PathBuf::from),
            settle: Duration::from_millis(self.settle),
            poll: self.poll.map(Duration::from_millis),
            hook: self.on_change.as_deref().map(|command| Hook::new(command, self.json)),
        })
    }

    fn output(&self, selection: &Selection) -> Result<PathBuf, SelectionError> {
        match (selection.find(std::slice::from_ref(&self.folder)), &selection.output) {
            (Ok(selected), _) => Ok(selected.output),
            // The user can correct a wrong file while the folder is watched.
            (Err(SelectionError::Config { .. } | SelectionError::Read { .. }), Some(output)) => Ok(output.clone()),
            (Err(reason), _) => Err(reason),
        }
    }
}

/// Prints events, as text or as JSON lines.
struct EventPrinter<'w> {
    out: &'w mut dyn Write,
    err: &'w mut dyn Write,
    is_json: bool,
    is_quiet: bool,
    is_verbose: bool,
}

impl EventPrinter<'_> {
    fn print_text(&mut self, event: &Event<'_>) -> io::Result<()> {
        let text = match event {
            _ if self.is_quiet => return Ok(()),
            Event::Started { folder, output, .. } => {
                let (folder, output) = (folder.0.display().to_string(), output.0.display().to_string());
                let (folder, output) = (printable(&folder), printable(&output));
                format!("watching {folder}, baking to {output}; Ctrl-C ends\n")
            }
            Event::Baked { input, seconds, done, .. } => {
                let asset = done.outcome((*input).to_owned(), None, *seconds);
                let notes = if self.is_verbose { String::new() } else { notes_to_act_on(slice::from_ref(&asset)) };
                summary(&asset, self.is_verbose) + &notes
            }
            Event::Removed { input, files } => {
                let input = input.0.display().to_string();
                format!("removed {}: {} file(s) of it\n", printable(&input), files.len())
            }
            Event::Failed { .. } | Event::Idle { .. } => return Ok(()),
        };
        self.out.write_all(text.as_bytes())?;
        self.out.flush()
    }
}

impl EventSink for EventPrinter<'_> {
    fn event(&mut self, event: &Event<'_>) -> io::Result<()> {
        if let Event::Failed { input, error, kept } = event {
            let subject = input.map_or_else(String::new, |input| format!("{input}: "));
            let stays =
                kept.map_or_else(String::new, |kept| format!("; {} stays as it was last baked", kept.display()));
            writeln!(self.err, "error: {subject}{error}{stays}")?;
        }
        if !self.is_json {
            return self.print_text(event);
        }
        serde_json::to_writer(&mut self.out, event)?;
        self.out.write_all(b"\n")?;
        self.out.flush()
    }

    fn note(&mut self, note: &dyn Display) -> io::Result<()> {
        if self.is_quiet { Ok(()) } else { writeln!(self.err, "note: {note}") }
    }

    fn warn(&mut self, warning: &dyn Display) -> io::Result<()> {
        writeln!(self.err, "warning: {warning}")
    }
}
