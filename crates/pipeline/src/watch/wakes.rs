//! When to look, by events of the file system.

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
    /// There are more folders than the system watches.
    #[error(
        "expected to watch every folder, found the system's limit reached; raise it (Linux: \
         fs.inotify.max_user_watches) or pass --poll"
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

/// Wakes the receiver at the other end. Several calls before the receiver looks wake it once.
#[derive(Clone, Debug)]
pub struct Wake(SyncSender<()>);

impl Wake {
    /// Returns the two ends of a channel.
    pub fn channel() -> (Self, Receiver<()>) {
        let (sender, receiver) = std::sync::mpsc::sync_channel(1);
        (Self(sender), receiver)
    }

    /// Wakes the receiver.
    pub fn wake(&self) {
        // A full channel wakes the receiver anyway.
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
    /// Folders came or went, so that folders must be watched again.
    has_new_folders: AtomicBool,
    is_over_limit: AtomicBool,
}

impl Wakes {
    /// Returns a watcher that wakes `wake` at every event that concerns the scope, which [`Wakes::follow`] sets.
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

    /// Returns whether `scope` is watched.
    pub fn is_following(&self, scope: &Scope) -> bool {
        *self.shared.scope.lock().unwrap_or_else(PoisonError::into_inner) == *scope
    }

    /// Watches the existing folders of `scope`. Call this before you look at files: later events wake.
    ///
    /// # Errors
    /// [`WatchError`] where the system does not watch as many folders: look from time to time instead.
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
        // A folder that was removed and made again is another folder, so all folders are watched again.
        for folder in &wanted {
            self.watch(folder, RecursiveMode::NonRecursive)?;
        }
        self.watched = wanted;
        if let Some(root) = self.root.take_if(|root| root != scope.root()) {
            let _ = self.watcher.unwatch(&root);
        }
        // The root comes last, so that a folder with two names is known by the name below the root.
        self.watch(scope.root(), RecursiveMode::Recursive)?;
        self.root = Some(scope.root().to_owned());
        Ok(())
    }

    fn watch(&mut self, folder: &Path, mode: RecursiveMode) -> Result<(), WatchError> {
        let Err(error) = self.watcher.watch(folder, mode) else { return Ok(()) };
        match &error.kind {
            // The user may lack the right to read folders above the root.
            _ if mode == RecursiveMode::NonRecursive && !matches!(error.kind, ErrorKind::MaxFilesWatch) => Ok(()),
            ErrorKind::PathNotFound => self.retry_later(folder),
            ErrorKind::Io(io) if io.kind() == std::io::ErrorKind::NotFound => self.retry_later(folder),
            _ => Err(error.into()),
        }
    }

    /// Requests another look, since a part of `folder` was removed while it was listed. The rest may not be watched
    /// yet.
    fn retry_later(&self, folder: &Path) -> Result<(), WatchError> {
        if folder.is_dir() {
            self.shared.has_new_folders.store(true, Ordering::Release);
            self.wake.wake();
        }
        Ok(())
    }
}

impl Shared {
    /// Returns whether `event` is a reason to look.
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
        // Reading a file, which the tool does, too, is no reason to look.
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
