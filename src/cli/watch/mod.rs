//! `roughcast watch`.

mod args;
mod asset;
mod documents;
mod events;
mod hook;
mod round;

use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::RecvTimeoutError;
use std::time::{Duration, Instant};

use super::selection::SelectionError;
pub use args::Args;

use crate::cli::outcome::Outcome;
use crate::watch::{Scope, Wake, Wakes, WatchError};
use events::{Event, EventWriter, Name};
use hook::Hook;
use round::Round;

/// How often all files are looked at where the system does not watch as many.
const POLL: Duration = Duration::from_secs(1);

/// Least and longest pause between two looks.
const LEAST_PAUSE: Duration = Duration::from_millis(2);
const LONGEST_PAUSE: Duration = Duration::from_millis(200);

/// Watches until it is told to stop.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &Args, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    let folder = &args.folder;
    if folder.exists() && !folder.is_dir() {
        let folder = folder.display();
        writeln!(err, "error: {folder}: expected a folder, found a file; bake it with `roughcast bake`")?;
        return Ok(Outcome::Usage);
    }
    let output = match (args.selection.find(std::slice::from_ref(folder)), &args.selection.output) {
        (Ok(selected), _) => selected.output,
        // A file that is wrong can be put right meanwhile.
        (Err(SelectionError::Config { .. } | SelectionError::Read { .. }), Some(output)) => output.clone(),
        (Err(reason), _) => {
            writeln!(err, "error: {reason}")?;
            return Ok(Outcome::Usage);
        }
    };
    let cache = match args.cache.open() {
        Ok(cache) => cache,
        Err(reason) => {
            writeln!(err, "error: {reason}")?;
            return Ok(Outcome::Usage);
        }
    };
    let (wake, woken) = Wake::channel();
    let stop = Arc::new(AtomicBool::new(false));
    let (told, waking) = (stop.clone(), wake.clone());
    // The second time, whoever asks does not want to wait. Shells start jobs in the
    // background with interrupts ignored; a signal that someone sends counts all the same.
    let _ = ctrlc::set_handler(move || {
        if told.swap(true, Ordering::AcqRel) {
            std::process::exit(130);
        }
        waking.wake();
    });
    let mut events = EventWriter::new(out, err, args.json, args.quiet);
    let mut poll = args.poll.map(Duration::from_millis);
    let mut wakes = None;
    let hook = args.on_change.as_deref().map(|command| Hook::new(command, args.json));
    let mut round = Round::new(args, output, cache);
    let mut is_first = true;
    loop {
        // First watch, then look: nothing happens in between.
        if poll.is_none()
            && let Err(error) = follow(&mut wakes, &wake, round.scope())
        {
            events.warn(&format_args!("{error}; looking at all files every {} ms instead", POLL.as_millis()))?;
            (wakes, poll) = (None, Some(POLL));
        }
        if is_first {
            events.write(&Event::Started {
                version: env!("CARGO_PKG_VERSION"),
                folder: Name(&args.folder),
                output: Name(round.output()),
                poll: poll.map(|poll| poll.as_millis() as u64),
            })?;
        }
        let next = round.run(args, &stop, &mut events, is_first)?;
        is_first = false;
        if stop.load(Ordering::Acquire) {
            return Ok(Outcome::Done);
        }
        if let Some(hook) = &hook
            && let Some(changes) = events.take_changes()
        {
            hook.run(&changes, &stop).iter().try_for_each(|error| events.warn(error))?;
        }
        let is_followed = wakes.as_ref().is_none_or(|wakes| wakes.is_following(round.scope()));
        if !is_followed {
            continue;
        }
        if next.is_idle {
            events.idle(round.counts())?;
        }
        // Looking takes half of the time at most, however many events there are.
        let earliest = Instant::now() + next.took.clamp(LEAST_PAUSE, LONGEST_PAUSE);
        let latest = [next.at, poll.map(|poll| Instant::now() + poll)].into_iter().flatten().min();
        let ended = match latest {
            None => woken.recv().is_err(),
            Some(at) => {
                let wait = at.max(earliest).saturating_duration_since(Instant::now());
                woken.recv_timeout(wait) == Err(RecvTimeoutError::Disconnected)
            }
        };
        if stop.load(Ordering::Acquire) || ended {
            return Ok(Outcome::Done);
        }
        std::thread::sleep(earliest.saturating_duration_since(Instant::now()));
    }
}

/// Watches what `scope` names.
fn follow(wakes: &mut Option<Wakes>, wake: &Wake, scope: &Scope) -> Result<(), WatchError> {
    match wakes {
        Some(wakes) => wakes.follow(scope),
        None => wakes.insert(Wakes::new(wake.clone())?).follow(scope),
    }
}
