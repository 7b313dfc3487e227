//! When to look: events of the system, or from time to time.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender};
use std::sync::{Arc, Mutex, PoisonError};

use notify::event::{AccessKind, AccessMode, EventKind, ModifyKind};
use notify::{ErrorKind, Event, RecommendedWatcher, RecursiveMode, Watcher, recommended_watcher};

use super::scope::Scope;

/// Why folders cannot be watched.
#[derive(Debug, thiserror::Error)]
pub enum WatchError {
    /// More folders than the system watches.
    #[error(
        "expected to watch every folder, found the system's limit reached; raise it (Linux: fs.inotify.max_user_watches) or pass --poll"
    )]
    Limit,
    /// The system refused.
    #[error("expected events of the file system, found: {0}; pass --poll where there are none")]
    System(notify::Error),
}

impl From<notify::Error> for WatchError {
    fn from(error: notify::Error) -> Self {
        match error.kind {
            ErrorKind::MaxFilesWatch => Self::Limit,
            _ => Self::System(error),
        }
    }
}

/// Wakes who waits on the other end. Any number of reasons to look are one.
#[derive(Clone, Debug)]
pub struct Wake(SyncSender<()>);

impl Wake {
    /// The two ends.
    pub fn channel() -> (Self, Receiver<()>) {
        let (sender, receiver) = std::sync::mpsc::sync_channel(1);
        (Self(sender), receiver)
    }

    /// Wakes.
    pub fn wake(&self) {
        // One that is full already wakes.
        let _ = self.0.try_send(());
    }
}

/// Events of the file system that concern a [`Scope`].
pub struct Wakes {
    watcher: RecommendedWatcher,
    wake: Wake,
    shared: Arc<Shared>,
    watched: BTreeSet<PathBuf>,
    root: Option<PathBuf>,
}

struct Shared {
    scope: Mutex<Scope>,
    /// Folders came or went: they must be watched anew.
    has_new_folders: AtomicBool,
    is_over_limit: AtomicBool,
}

impl Wakes {
    /// Wakes `wake` when something happens that concerns the scope, which [`Wakes::follow`] sets.
    ///
    /// # Errors
    /// [`WatchError`] where the system has no events.
    pub fn new(wake: Wake) -> Result<Self, WatchError> {
        let shared = Arc::new(Shared {
            scope: Mutex::new(Scope::default()),
            has_new_folders: AtomicBool::new(true),
            is_over_limit: AtomicBool::new(false),
        });
        let (handler, waking) = (shared.clone(), wake.clone());
        let watcher = recommended_watcher(move |event: notify::Result<Event>| {
            if handler.is_news(event) {
                waking.wake();
            }
        })?;
        Ok(Self { watcher, wake, shared, watched: BTreeSet::new(), root: None })
    }

    /// Whether `scope` is what is watched.
    pub fn is_following(&self, scope: &Scope) -> bool {
        *self.shared.scope.lock().unwrap_or_else(PoisonError::into_inner) == *scope
    }

    /// Watches what `scope` names, as far as it exists. Call it before files are looked at: what happens later wakes.
    ///
    /// # Errors
    /// [`WatchError`] where that is more than the system watches: look from time to time instead.
    pub fn follow(&mut self, scope: &Scope) -> Result<(), WatchError> {
        let has_new_folders = self.shared.has_new_folders.swap(false, Ordering::AcqRel);
        let is_other = !self.is_following(scope);
        self.shared.scope.lock().unwrap_or_else(PoisonError::into_inner).clone_from(scope);
        if self.shared.is_over_limit.load(Ordering::Acquire) {
            return Err(WatchError::Limit);
        }
        if !has_new_folders && !is_other {
            return Ok(());
        }
        let wanted = scope.folders();
        for folder in self.watched.difference(&wanted) {
            let _ = self.watcher.unwatch(folder);
        }
        // A folder that was removed and made again under its name is another one, so all are watched again.
        for folder in &wanted {
            self.watch(folder, RecursiveMode::NonRecursive)?;
        }
        self.watched = wanted;
        if let Some(root) = self.root.take_if(|root| root != scope.root()) {
            let _ = self.watcher.unwatch(&root);
        }
        // The root comes last: a folder that is reached by two names has the one below the root.
        self.watch(scope.root(), RecursiveMode::Recursive)?;
        self.root = Some(scope.root().to_owned());
        Ok(())
    }

    fn watch(&mut self, folder: &Path, mode: RecursiveMode) -> Result<(), WatchError> {
        let Err(error) = self.watcher.watch(folder, mode) else { return Ok(()) };
        match &error.kind {
            // The folders above need not be ours to read.
            _ if mode == RecursiveMode::NonRecursive && !matches!(error.kind, ErrorKind::MaxFilesWatch) => Ok(()),
            ErrorKind::PathNotFound => self.retry_later(folder),
            ErrorKind::Io(io) if io.kind() == std::io::ErrorKind::NotFound => self.retry_later(folder),
            _ => Err(error.into()),
        }
    }

    /// Part of `folder` went away while it was listed, and what comes after it may not be watched yet.
    fn retry_later(&self, folder: &Path) -> Result<(), WatchError> {
        if folder.is_dir() {
            self.shared.has_new_folders.store(true, Ordering::Release);
            self.wake.wake();
        }
        Ok(())
    }
}

impl Shared {
    /// Whether `event` is a reason to look.
    fn is_news(&self, event: notify::Result<Event>) -> bool {
        let event = match event {
            Ok(event) => event,
            Err(error) => {
                let is_over_limit = matches!(error.kind, ErrorKind::MaxFilesWatch);
                self.is_over_limit.fetch_or(is_over_limit, Ordering::AcqRel);
                return true;
            }
        };
        if event.need_rescan() {
            self.has_new_folders.store(true, Ordering::Release);
            return true;
        }
        // Reading, ours among it, is no news.
        if matches!(event.kind, EventKind::Access(kind) if kind != AccessKind::Close(AccessMode::Write)) {
            return false;
        }
        let concerns = {
            let scope = self.scope.lock().unwrap_or_else(PoisonError::into_inner);
            event.paths.iter().any(|path| scope.concerns(path))
        };
        let is_of_names =
            matches!(event.kind, EventKind::Create(_) | EventKind::Remove(_) | EventKind::Modify(ModifyKind::Name(_)));
        if concerns && is_of_names && event.paths.iter().any(|path| path.is_dir() || !path.exists()) {
            self.has_new_folders.store(true, Ordering::Release);
        }
        concerns
    }
}
