//! One look at the folder: what is to be baked, what was removed, and what must wait because it is still being written.

mod bake;

use std::collections::{BTreeMap, HashSet};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::asset::{KnownAsset, Looks, Planned, State};
use super::documents::Documents;
use super::journal::Journal;
use super::ledger::Ledger;
use super::look::Look;
use super::options::WatchOptions;
use super::scope::{Scope, real};
use super::settling::Settling;
use crate::cache::Cache;
use crate::output::Guard;
use crate::project::{Input, InputError, Resolved, Selected};

/// The state that is kept from one look to the next.
pub struct Round {
    output: PathBuf,
    cache: Option<Cache>,
    window: Duration,
    settling: Settling,
    assets: BTreeMap<PathBuf, KnownAsset>,
    configs: BTreeMap<PathBuf, Option<Look>>,
    documents: Documents,
    /// Whether the note on documents that are left out was reported.
    has_noted_baked: bool,
    ledger: Ledger,
    scope: Scope,
    /// What is wrong with the folder, and whether that was reported. A problem is reported if it lasts until the next
    /// look.
    complaints: BTreeMap<String, bool>,
}

/// What comes next.
pub struct Next {
    /// When to look again, even if nothing happens.
    pub at: Option<Instant>,
    /// Whether nothing is left to do.
    pub is_idle: bool,
    /// How long the look took, without the bakes.
    pub took: Duration,
}

impl Round {
    /// Returns the state before the first look.
    pub fn new(options: &WatchOptions) -> Self {
        let mut round = Self {
            output: options.output.clone(),
            cache: options.cache.clone(),
            window: options.settle,
            settling: Settling::new(options.settle),
            assets: BTreeMap::new(),
            configs: BTreeMap::new(),
            documents: Documents::default(),
            has_noted_baked: false,
            ledger: Ledger::default(),
            scope: Scope::default(),
            complaints: BTreeMap::new(),
        };
        round.scope = round.current_scope(options);
        round
    }

    /// Returns the output folder.
    pub fn output(&self) -> &Path {
        &self.output
    }

    /// Returns the paths that matter to the known assets.
    pub fn scope(&self) -> &Scope {
        &self.scope
    }

    /// Returns the number of assets and the number of failed assets.
    pub fn counts(&self) -> (usize, usize) {
        let failed = self.assets.values().filter(|asset| matches!(asset.state, State::Failed { .. })).count();
        (self.assets.len(), failed)
    }

    /// Looks at all files and bakes what changed. The `first` look does not wait for files that are being written.
    pub fn run(
        &mut self,
        options: &WatchOptions,
        stop: &AtomicBool,
        journal: &mut Journal<'_>,
        first: bool,
    ) -> io::Result<Next> {
        let now = Instant::now();
        let (mut retry, mut baking) = (None, Duration::ZERO);
        if let Some(selected) = self.select(options, journal, first)?
            && (first || self.has_settled_configs(&selected.configs, now))
        {
            let configs = selected.configs.iter().map(|path| (path.clone(), Look::at(path))).collect();
            let mut is_same_scope = self.configs == configs && self.output == selected.output;
            (self.configs, self.output) = (configs, selected.output);
            is_same_scope &= !self.forget_missing(&selected.assets, now);
            journal.removed(&self.ledger.sweep())?;
            let planned = self.plan(&selected.assets, now, first);
            if planned.iter().any(Option::is_some) {
                is_same_scope = false;
                let start = Instant::now();
                retry = self.bake(&selected.assets, planned, stop, journal)?;
                baking = start.elapsed();
                journal.removed(&self.ledger.sweep())?;
                if let Some(cache) = &self.cache {
                    cache.trim(&mut |error| drop(journal.warn(&error)));
                }
            }
            if !is_same_scope {
                self.scope = self.current_scope(options);
            }
        }
        if real(&options.folder) != self.scope.root() {
            self.scope = self.current_scope(options);
        }
        let unreported = self.complaints.values().any(|was_reported| !was_reported).then(|| now + self.window);
        let waits = [self.settling.pending(now), unreported, retry.filter(Duration::is_zero).map(|_| now)];
        let is_idle = waits.iter().all(Option::is_none);
        let at = waits.into_iter().flatten().chain(retry.map(|retry| Instant::now() + retry)).min();
        Ok(Next { at, is_idle, took: now.elapsed().saturating_sub(baking) })
    }

    fn current_scope(&self, options: &WatchOptions) -> Scope {
        let ours: Vec<&Path> = [self.output.as_path()].into_iter().chain(options.cache_folder.as_deref()).collect();
        let files = self.assets.values().flat_map(|asset| &asset.seen).map(|(path, _)| path.as_path());
        Scope::new(&options.folder, &ours, files.chain(self.configs.keys().map(PathBuf::as_path)))
    }

    /// Returns the current assets; `None` where they are not known, or not known yet. Then all outputs stay as they
    /// are.
    fn select(
        &mut self,
        options: &WatchOptions,
        journal: &mut Journal<'_>,
        first: bool,
    ) -> io::Result<Option<Selected>> {
        let folder = &options.folder;
        let (mut selected, mut wrong) = (None, Vec::new());
        if folder.is_dir() {
            let is_baked = &mut |path: &Path| self.documents.is_baked(path);
            match options.selection.find_by(std::slice::from_ref(folder), is_baked) {
                Ok(found) => {
                    if let Some(note) = found.note_of_baked().filter(|_| !self.has_noted_baked) {
                        self.has_noted_baked = true;
                        journal.note(&note)?;
                    }
                    // A folder without assets may get some.
                    let errors = found.errors.iter().filter(|error| !matches!(error, InputError::EmptyFolder { .. }));
                    wrong.extend(errors.map(ToString::to_string));
                    selected = found.is_safe().then_some(found);
                }
                Err(reason) => wrong.push(reason.to_string()),
            }
        } else {
            wrong.push(format!("{}: expected a folder, found none; waiting for it", folder.display()));
        }
        // Problems that come and go while a folder is listed or a file is written are not reported.
        let before = std::mem::take(&mut self.complaints);
        for complaint in wrong {
            let was_reported = before.get(&complaint).copied();
            if was_reported == Some(false) || (first && was_reported.is_none()) {
                journal.failed(None, &complaint, None)?;
            }
            self.complaints.insert(complaint, first || was_reported.is_some());
        }
        let is_lasting = self.complaints.values().all(|was_reported| *was_reported);
        Ok(selected.filter(|_| is_lasting))
    }

    /// Returns whether no configuration that came, changed or went is still being written.
    fn has_settled_configs(&mut self, configs: &[PathBuf], now: Instant) -> bool {
        let gone = self.configs.keys().filter(|path| !configs.contains(path));
        configs.iter().chain(gone).fold(true, |all, path| {
            let look = Look::at(path);
            (self.configs.get(path) == Some(&look) || self.settling.is_settled(path, look, now)) && all
        })
    }

    /// Forgets assets that were removed, and takes their outputs from them. Returns whether there were any.
    fn forget_missing(&mut self, selected: &[(Input, Resolved)], now: Instant) -> bool {
        let present: HashSet<&Path> = selected.iter().map(|(input, _)| input.path.as_path()).collect();
        let count = self.assets.len();
        self.assets.retain(|source, _| {
            let stays = present.contains(source.as_path()) || !self.settling.is_settled(source, Look::at(source), now);
            if !stays {
                self.ledger.set(source, &self.output, &[]);
            }
            stays
        });
        self.assets.len() < count
    }

    /// Plans the assets that may have changed and are not being written.
    fn plan(&mut self, selected: &[(Input, Resolved)], now: Instant, first: bool) -> Vec<Option<Planned>> {
        let changed = |(input, resolved): &(Input, Resolved)| match self.assets.get(&input.path) {
            Some(asset) => asset.changed(input, resolved),
            None => Some(vec![(input.path.clone(), Look::at(&input.path))]),
        };
        let changed: Vec<Option<Looks>> = selected.par_iter().map(changed).collect();
        // All files are asked for, since each settles from the time when it is first asked for.
        let settling = &mut self.settling;
        let mut are_settled = |files: &Looks| {
            first || files.iter().fold(true, |all, (path, look)| settling.is_settled(path, *look, now) && all)
        };
        let are_ready: Vec<bool> = changed.iter().map(|files| files.as_ref().is_some_and(&mut are_settled)).collect();
        let plan =
            |((input, resolved), is_ready): (&(Input, Resolved), bool)| is_ready.then(|| Planned::new(input, resolved));
        let planned: Vec<Option<Planned>> = selected.par_iter().zip(are_ready).map(plan).collect();
        // A file may have changed since it was looked at above, and a new document may refer to new files.
        let is_settled = |(planned, (input, _)): (Option<Planned>, &(Input, Resolved))| {
            planned.filter(|planned| are_settled(&planned.changed_files(self.assets.get(&input.path))))
        };
        planned.into_iter().zip(selected).map(is_settled).collect()
    }

    /// Returns the guard of this look: it may write inside the output folder only, and over no file that is read.
    fn guard(&self, planned: &[Option<Planned>]) -> Guard {
        let mut guard = Guard::inside(&self.output);
        self.configs.keys().for_each(|path| guard.add_source(path));
        self.assets.values().flat_map(|asset| &asset.seen).for_each(|(path, _)| guard.add_source(path));
        planned.iter().flatten().flat_map(|planned| &planned.seen).for_each(|(path, _)| guard.add_source(path));
        guard
    }
}
