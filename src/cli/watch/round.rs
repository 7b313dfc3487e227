//! One look at the folder: what is to be baked, what is gone, and what must wait since it is still being written.

use std::collections::{BTreeMap, HashSet};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::Args;
use super::asset::{Asset, Looks, Planned, State};
use super::events::Teller;
use crate::bake::{Places, PublishError};
use crate::cache::{Cache, CacheError};
use crate::cli::inputs::{Input, InputError};
use crate::cli::selection::Selected;
use crate::config::Resolved;
use crate::plan::{self, Lookup, Room, RunError};
use crate::watch::{Ledger, Look, Scope, Settling, real};

/// After how long a lock or a vanished disk is tried again.
const RETRY: Duration = Duration::from_secs(1);

/// All that is remembered from one look to the next.
pub struct Round {
    output: PathBuf,
    cache: Option<Cache>,
    window: Duration,
    settling: Settling,
    assets: BTreeMap<PathBuf, Asset>,
    configs: BTreeMap<PathBuf, Option<Look>>,
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
    pub fn run(&mut self, args: &Args, stop: &AtomicBool, teller: &mut Teller<'_>, first: bool) -> io::Result<Next> {
        let now = Instant::now();
        let (mut retry, mut baking) = (None, Duration::ZERO);
        if let Some(selected) = self.select(args, teller, first)?
            && (first || self.has_settled_configs(&selected.configs, now))
        {
            let configs = selected.configs.iter().map(|path| (path.clone(), Look::at(path))).collect();
            let mut is_same_scope = self.configs == configs && self.output == selected.output;
            (self.configs, self.output) = (configs, selected.output);
            is_same_scope &= !self.forget_others(&selected.assets, now);
            teller.removed(&self.ledger.sweep())?;
            let planned = self.plan(&selected.assets, now, first);
            if planned.iter().any(Option::is_some) {
                is_same_scope = false;
                let start = Instant::now();
                retry = self.work(&selected.assets, planned, stop, teller)?;
                baking = start.elapsed();
                teller.removed(&self.ledger.sweep())?;
                if let Some(cache) = &self.cache {
                    cache.trim(&mut |error| drop(teller.warn(&error)));
                }
            }
            if !is_same_scope {
                self.scope = self.current_scope(args);
            }
        }
        if real(&args.folder) != self.scope.root() {
            self.scope = self.current_scope(args);
        }
        let untold = self.complaints.values().any(|was_told| !was_told).then(|| now + self.window);
        let waits = [self.settling.pending(now), untold, retry.filter(Duration::is_zero).map(|_| now)];
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
    fn select(&mut self, args: &Args, teller: &mut Teller<'_>, first: bool) -> io::Result<Option<Selected>> {
        let folder = &args.folder;
        let (mut selected, mut wrong) = (None, Vec::new());
        if folder.is_dir() {
            match args.selection.find(std::slice::from_ref(folder)) {
                Ok(found) => {
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
            let was_told = before.get(&complaint).copied();
            if was_told == Some(false) || (first && was_told.is_none()) {
                teller.failed(None, &complaint)?;
            }
            self.complaints.insert(complaint, first || was_told.is_some());
        }
        let is_lasting = self.complaints.values().all(|was_told| *was_told);
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

    /// Bakes what is `planned`; returns after how long to try again, if that may help.
    fn work(
        &mut self,
        selected: &[(Input, Resolved)],
        mut planned: Vec<Option<Planned>>,
        stop: &AtomicBool,
        teller: &mut Teller<'_>,
    ) -> io::Result<Option<Duration>> {
        for ((input, resolved), slot) in selected.iter().zip(&mut planned) {
            if let Some(known) = self.assets.get_mut(&input.path)
                && let Some(planned) = slot.take_if(|planned| known.is_as(planned, input))
            {
                // Touched, or changed and changed back.
                (known.seen, known.values) = (planned.seen, resolved.values.clone());
            }
        }
        let look_up =
            |planned: &Option<Planned>| Some(Lookup::new(planned.as_ref()?.job.as_ref().ok()?, self.cache.as_ref()?));
        let lookups: Vec<Option<Lookup>> = planned.par_iter().map(look_up).collect();
        let (mut places, room) = (Places::default(), Room::new(1));
        let mut retry: Option<Duration> = None;
        let mut soon = |after: Option<Duration>| retry = [retry, after].into_iter().flatten().min();
        for (((input, resolved), planned), lookup) in selected.iter().zip(planned).zip(lookups) {
            let Some(Planned { job, seen }) = planned else {
                // An asset keeps its places unless one before it takes them, as in a bake of all.
                if let Some(Asset { state, .. }) = self.assets.get_mut(&input.path)
                    && let State::Done(written) = state
                    && !written.iter().all(|file| places.hold(&file.path, &file.source))
                {
                    *state = State::Failed { error: String::new(), again: true };
                    soon(Some(Duration::ZERO));
                }
                continue;
            };
            if stop.load(Ordering::Acquire) {
                break;
            }
            let (start, name) = (Instant::now(), input.path.display().to_string());
            let id = job.as_ref().ok().map(|job| job.id);
            let mut warn = |error: CacheError| {
                let whose = if error.is_general() { String::new() } else { format!("{name}: ") };
                // The bake does not depend on who reads this.
                let _ = teller.warn(&format_args!("{whose}{error}"));
            };
            let result = job.and_then(|job| {
                let prepared = plan::prepare(&job, lookup, &room, &|_| ());
                plan::finish(&job, prepared, &mut places, &mut warn)
            });
            let state = match result {
                Ok(done) => {
                    teller.baked(name, &done, start.elapsed().as_secs_f64())?;
                    self.ledger.set(&input.path, &self.output, &done.written);
                    State::Done(done.written)
                }
                Err(error) => {
                    soon(retry_after(&error));
                    let text = error.to_string();
                    let known = self.assets.get(&input.path);
                    // A file that was written to meanwhile is one that had not settled.
                    let is_news = !matches!(error, RunError::Changed { .. });
                    if is_news && !known.is_some_and(|known| known.has_failed_so(&text, &seen)) {
                        teller.failed(Some(&name), &text)?;
                    }
                    if !keeps_outputs(&error) {
                        self.ledger.set(&input.path, &self.output, &[]);
                    }
                    let again = keeps_outputs(&error) || matches!(error, RunError::Publish(_));
                    State::Failed { error: text, again }
                }
            };
            let asset = Asset { output: input.folder.clone(), values: resolved.values.clone(), id, seen, state };
            self.assets.insert(input.path.clone(), asset);
        }
        Ok(retry)
    }
}

/// When to try again, even if nothing happens.
fn retry_after(error: &RunError) -> Option<Duration> {
    match error {
        RunError::Changed { .. } => Some(Duration::ZERO),
        _ => error.is_passing().then_some(RETRY),
    }
}

/// Whether nothing is wrong with the asset itself.
fn keeps_outputs(error: &RunError) -> bool {
    let is_of_disk = matches!(error, RunError::Publish(PublishError::Write { .. }) | RunError::NoOutput { .. });
    error.is_passing() || is_of_disk
}
