//! One look at the folder: what is to be baked, what is gone, and what must wait since it is still being written.

mod work;

use std::collections::{BTreeMap, HashSet};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::args::Args;
use super::asset::{Asset, Looks, Planned, State};
use super::documents::Documents;
use super::events::EventWriter;
use crate::cache::Cache;
use crate::cli::selection::Selected;
use crate::output::Guard;
use crate::project::{Input, InputError, Resolved};
use crate::watch::{Ledger, Look, Scope, Settling, real};

/// All that is remembered from one look to the next.
pub struct Round {
    output: PathBuf,
    cache: Option<Cache>,
    window: Duration,
    settling: Settling,
    assets: BTreeMap<PathBuf, Asset>,
    configs: BTreeMap<PathBuf, Option<Look>>,
    documents: Documents,
    /// Whether somebody was told of documents that are left out.
    told_of_baked: bool,
    ledger: Ledger,
    scope: Scope,
    /// What is wrong with the folder, and whether it was told: it is when it is still wrong at the next look.
    complaints: BTreeMap<String, bool>,
}

/// What comes next.
pub struct Next {
    /// When to look again, even if nothing happens.
    pub at: Option<Instant>,
    /// Whether nothing is left to do.
    pub is_idle: bool,
    /// How long it took to look, without what was baked.
    pub took: Duration,
}

impl Round {
    /// Nothing is known yet; outputs go to `output` and are kept in `cache`.
    pub fn new(args: &Args, output: PathBuf, cache: Option<Cache>) -> Self {
        let window = Duration::from_millis(args.settle);
        let mut round = Self {
            output,
            cache,
            window,
            settling: Settling::new(window),
            assets: BTreeMap::new(),
            configs: BTreeMap::new(),
            documents: Documents::default(),
            told_of_baked: false,
            ledger: Ledger::default(),
            scope: Scope::default(),
            complaints: BTreeMap::new(),
        };
        round.scope = round.current_scope(args);
        round
    }

    /// Where outputs go.
    pub fn output(&self) -> &Path {
        &self.output
    }

    /// What matters to the assets that are known.
    pub fn scope(&self) -> &Scope {
        &self.scope
    }

    /// Numbers of assets and of those that failed.
    pub fn counts(&self) -> (usize, usize) {
        let failed = self.assets.values().filter(|asset| matches!(asset.state, State::Failed { .. })).count();
        (self.assets.len(), failed)
    }

    /// Looks at everything and bakes what changed; the `first` time without waiting for what is being written.
    pub fn run(
        &mut self,
        args: &Args,
        stop: &AtomicBool,
        events: &mut EventWriter<'_>,
        first: bool,
    ) -> io::Result<Next> {
        let now = Instant::now();
        let (mut retry, mut baking) = (None, Duration::ZERO);
        if let Some(selected) = self.select(args, events, first)?
            && (first || self.has_settled_configs(&selected.configs, now))
        {
            let configs = selected.configs.iter().map(|path| (path.clone(), Look::at(path))).collect();
            let mut is_same_scope = self.configs == configs && self.output == selected.output;
            (self.configs, self.output) = (configs, selected.output);
            is_same_scope &= !self.forget_others(&selected.assets, now);
            events.removed(&self.ledger.sweep())?;
            let planned = self.plan(&selected.assets, now, first);
            if planned.iter().any(Option::is_some) {
                is_same_scope = false;
                let start = Instant::now();
                retry = self.work(&selected.assets, planned, stop, events)?;
                baking = start.elapsed();
                events.removed(&self.ledger.sweep())?;
                if let Some(cache) = &self.cache {
                    cache.trim(&mut |error| drop(events.warn(&error)));
                }
            }
            if !is_same_scope {
                self.scope = self.current_scope(args);
            }
        }
        if real(&args.folder) != self.scope.root() {
            self.scope = self.current_scope(args);
        }
        let unreported = self.complaints.values().any(|was_reported| !was_reported).then(|| now + self.window);
        let waits = [self.settling.pending(now), unreported, retry.filter(Duration::is_zero).map(|_| now)];
        let is_idle = waits.iter().all(Option::is_none);
        let at = waits.into_iter().flatten().chain(retry.map(|retry| Instant::now() + retry)).min();
        Ok(Next { at, is_idle, took: now.elapsed().saturating_sub(baking) })
    }

    fn current_scope(&self, args: &Args) -> Scope {
        let ours: Vec<&Path> = [self.output.as_path()].into_iter().chain(args.cache.folder()).collect();
        let files = self.assets.values().flat_map(|asset| &asset.seen).map(|(path, _)| path.as_path());
        Scope::new(&args.folder, &ours, files.chain(self.configs.keys().map(PathBuf::as_path)))
    }

    /// The assets that are there now; `None` where that cannot be told, or not yet: outputs stay as they are.
    fn select(&mut self, args: &Args, events: &mut EventWriter<'_>, first: bool) -> io::Result<Option<Selected>> {
        let folder = &args.folder;
        let (mut selected, mut wrong) = (None, Vec::new());
        if folder.is_dir() {
            let is_baked = &mut |path: &Path| self.documents.is_baked(path);
            match args.selection.find_by(std::slice::from_ref(folder), is_baked) {
                Ok(found) => {
                    if let Some(note) = found.note_of_baked().filter(|_| !self.told_of_baked) {
                        self.told_of_baked = true;
                        events.note(&note)?;
                    }
                    // Assets of a folder without any are still to come.
                    let errors = found.errors.iter().filter(|error| !matches!(error, InputError::EmptyFolder { .. }));
                    wrong.extend(errors.map(ToString::to_string));
                    let is_safe = !found.errors.iter().any(|error| matches!(error, InputError::OutputIsInput { .. }));
                    selected = is_safe.then_some(found);
                }
                Err(reason) => wrong.push(reason.to_string()),
            }
        } else {
            wrong.push(format!("{}: expected a folder, found none; waiting for it", folder.display()));
        }
        // What comes and goes while a folder is listed or a file is written is not worth a word.
        let before = std::mem::take(&mut self.complaints);
        for complaint in wrong {
            let was_reported = before.get(&complaint).copied();
            if was_reported == Some(false) || (first && was_reported.is_none()) {
                events.failed(None, &complaint, None)?;
            }
            self.complaints.insert(complaint, first || was_reported.is_some());
        }
        let is_lasting = self.complaints.values().all(|was_reported| *was_reported);
        Ok(selected.filter(|_| is_lasting))
    }

    /// Whether no configuration that came, changed or went is still being written.
    fn has_settled_configs(&mut self, configs: &[PathBuf], now: Instant) -> bool {
        let gone = self.configs.keys().filter(|path| !configs.contains(path));
        configs.iter().chain(gone).fold(true, |all, path| {
            let look = Look::at(path);
            (self.configs.get(path) == Some(&look) || self.settling.is_settled(path, look, now)) && all
        })
    }

    /// Assets that are gone for good have no outputs any more; whether there are such.
    fn forget_others(&mut self, selected: &[(Input, Resolved)], now: Instant) -> bool {
        let there: HashSet<&Path> = selected.iter().map(|(input, _)| input.path.as_path()).collect();
        let count = self.assets.len();
        self.assets.retain(|source, _| {
            let stays = there.contains(source.as_path()) || !self.settling.is_settled(source, Look::at(source), now);
            if !stays {
                self.ledger.set(source, &self.output, &[]);
            }
            stays
        });
        self.assets.len() < count
    }

    /// Plans what may be other than it was and is not being written.
    fn plan(&mut self, selected: &[(Input, Resolved)], now: Instant, first: bool) -> Vec<Option<Planned>> {
        let changed = |(input, resolved): &(Input, Resolved)| match self.assets.get(&input.path) {
            Some(asset) => asset.changed(input, resolved),
            None => Some(vec![(input.path.clone(), Look::at(&input.path))]),
        };
        let changed: Vec<Option<Looks>> = selected.par_iter().map(changed).collect();
        // Each is asked for, so that all settle side by side.
        let settling = &mut self.settling;
        let mut are_settled = |files: &Looks| {
            first || files.iter().fold(true, |all, (path, look)| settling.is_settled(path, *look, now) && all)
        };
        let are_ready: Vec<bool> = changed.iter().map(|files| files.as_ref().is_some_and(&mut are_settled)).collect();
        let plan =
            |((input, resolved), is_ready): (&(Input, Resolved), bool)| is_ready.then(|| Planned::new(input, resolved));
        let planned: Vec<Option<Planned>> = selected.par_iter().zip(are_ready).map(plan).collect();
        let are_new_settled = |(planned, (input, _)): (Option<Planned>, &(Input, Resolved))| {
            planned.filter(|planned| are_settled(&planned.new_files(input, self.assets.get(&input.path))))
        };
        planned.into_iter().zip(selected).map(are_new_settled).collect()
    }

    /// What decides where this look may write.
    fn guard(&self, planned: &[Option<Planned>]) -> Guard {
        let mut guard = Guard::inside(&self.output);
        self.configs.keys().for_each(|path| guard.add_source(path));
        self.assets.values().flat_map(|asset| &asset.seen).for_each(|(path, _)| guard.add_source(path));
        planned.iter().flatten().flat_map(|planned| &planned.seen).for_each(|(path, _)| guard.add_source(path));
        guard
    }
}
