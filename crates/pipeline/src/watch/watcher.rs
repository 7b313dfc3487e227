//! The loop of watching: look, bake what changed, wait for the next reason to look.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use super::event::{Event, EventSink, Name, WATCH_FORMAT};
use super::journal::Journal;
use super::options::WatchOptions;
use super::round::{Next, Round};
use super::scope::Scope;
use super::wakes::{Wake, Wakes, WatchError};

/// The time between two looks where the system cannot watch all folders.
const POLL: Duration = Duration::from_secs(1);

/// The shortest pause between two looks.
const MIN_PAUSE: Duration = Duration::from_millis(2);

/// The longest pause between two looks while there are reasons to look.
const MAX_PAUSE: Duration = Duration::from_millis(200);

/// Stops a [`Watcher`], from any thread.
#[derive(Clone, Debug)]
pub struct Stop {
    is_requested: Arc<AtomicBool>,
    wake: Wake,
}

impl Stop {
    /// Asks the watcher to stop after the asset at work. Returns whether it was asked before.
    pub fn request(&self) -> bool {
        let was_requested = self.is_requested.swap(true, Ordering::AcqRel);
        self.wake.wake();
        was_requested
    }

    fn is_requested(&self) -> bool {
        self.is_requested.load(Ordering::Acquire)
    }
}

/// Watches a folder of assets.
pub struct Watcher {
    options: WatchOptions,
    stop: Stop,
    woken: Receiver<()>,
    /// The time between two looks; `None` while the system reports changes.
    poll: Option<Duration>,
    wakes: Option<Wakes>,
    round: Round,
}

impl Watcher {
    /// Returns a watcher that has not begun.
    pub fn new(options: WatchOptions) -> Self {
        let (wake, woken) = Wake::channel();
        let stop = Stop { is_requested: Arc::default(), wake };
        let (poll, round) = (options.poll, Round::new(&options));
        Self { options, stop, woken, poll, wakes: None, round }
    }

    /// Returns what stops the watcher.
    pub fn stop(&self) -> Stop {
        self.stop.clone()
    }

    /// Watches until it is stopped.
    ///
    /// # Errors
    /// The first error of `sink`.
    pub fn run(mut self, sink: &mut dyn EventSink) -> io::Result<()> {
        let mut journal = Journal::new(sink);
        let mut is_first = true;
        loop {
            self.follow(&mut journal)?;
            if is_first {
                journal.event(&Event::Started {
                    format_version: WATCH_FORMAT,
                    version: env!("CARGO_PKG_VERSION"),
                    folder: Name(&self.options.folder),
                    output: Name(self.round.output()),
                    poll: self.poll.map(|poll| poll.as_millis() as u64),
                })?;
            }
            let next = self.round.run(&self.options, &self.stop.is_requested, &mut journal, is_first)?;
            is_first = false;
            if self.stop.is_requested() {
                return Ok(());
            }
            self.run_hook(&mut journal)?;
            if !self.wakes.as_ref().is_none_or(|wakes| wakes.is_following(self.round.scope())) {
                continue;
            }
            if next.is_idle {
                journal.idle(self.round.counts())?;
            }
            if self.wait(&next) {
                return Ok(());
            }
        }
    }

    /// Makes the system report changes of the current scope, before the files are looked at: a change between the two
    /// is not missed. Looks from time to time instead where the system refuses.
    fn follow(&mut self, journal: &mut Journal<'_>) -> io::Result<()> {
        if self.poll.is_none()
            && let Err(error) = follow(&mut self.wakes, &self.stop.wake, self.round.scope())
        {
            journal.warn(&format_args!("{error}; looking at all files every {} ms instead", POLL.as_millis()))?;
            (self.wakes, self.poll) = (None, Some(POLL));
        }
        Ok(())
    }

    /// Runs the hook if outputs changed.
    fn run_hook(&self, journal: &mut Journal<'_>) -> io::Result<()> {
        if let Some(hook) = &self.options.hook
            && let Some(changes) = journal.take_changes()
        {
            hook.run(&changes, &self.stop.is_requested).iter().try_for_each(|error| journal.warn(error))?;
        }
        Ok(())
    }

    /// Waits for the next reason to look. Returns whether the watcher is to stop.
    fn wait(&self, next: &Next) -> bool {
        // Looking takes half of the time at most, however many events there are.
        let earliest = Instant::now() + next.took.clamp(MIN_PAUSE, MAX_PAUSE);
        let latest = [next.at, self.poll.map(|poll| Instant::now() + poll)].into_iter().flatten().min();
        let has_ended = match latest {
            None => self.woken.recv().is_err(),
            Some(at) => {
                let wait = at.max(earliest).saturating_duration_since(Instant::now());
                self.woken.recv_timeout(wait) == Err(RecvTimeoutError::Disconnected)
            }
        };
        if self.stop.is_requested() || has_ended {
            return true;
        }
        thread::sleep(earliest.saturating_duration_since(Instant::now()));
        false
    }
}

/// Watches what `scope` names.
fn follow(wakes: &mut Option<Wakes>, wake: &Wake, scope: &Scope) -> Result<(), WatchError> {
    match wakes {
        Some(wakes) => wakes.follow(scope),
        None => wakes.insert(Wakes::new(wake.clone())?).follow(scope),
    }
}
