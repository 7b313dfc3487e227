//! The progress bar: on a terminal only.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::remote::Counts;
use crate::text::printable;

/// Steps per asset.
const STEPS: f32 = 1000.0;

/// A bar over assets, of which each moves it by its share.
pub struct Progress {
    bar: ProgressBar,
    /// Steps that each asset is along.
    along: Vec<AtomicU64>,
    /// Whether a server counts, and names say nothing.
    is_counted: AtomicBool,
}

impl Progress {
    /// For `assets` assets; hidden when `quiet` or when standard error is no terminal.
    pub fn new(assets: usize, quiet: bool) -> Self {
        let along = (0..assets).map(|_| AtomicU64::new(0)).collect();
        if quiet {
            return Self { bar: ProgressBar::hidden(), along, is_counted: AtomicBool::new(false) };
        }
        let bar = ProgressBar::new((assets as f32 * STEPS) as u64);
        let style = ProgressStyle::with_template("{elapsed_precise} [{bar:40}] {percent:>3} %  {msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
        bar.enable_steady_tick(Duration::from_millis(200));
        Self { bar, along, is_counted: AtomicBool::new(false) }
    }

    /// Work on asset `index` (from 0) has reached `share` (0 to 1).
    pub fn set(&self, index: usize, share: f32, name: &str) {
        let now = (share * STEPS) as u64;
        let before = self.along.get(index).map_or(now, |along| along.fetch_max(now, Ordering::Relaxed));
        self.bar.inc(now.saturating_sub(before));
        if !self.is_counted.load(Ordering::Relaxed) {
            self.bar.set_message(printable(name).into_owned());
        }
    }

    /// A server is so far with all that it was sent.
    pub fn count(&self, counts: Counts) {
        let Counts { queued, running, known, done, .. } = counts;
        self.is_counted.store(true, Ordering::Relaxed);
        self.bar.set_message(format!("{queued} queued, {running} running, {done} done, {known} of them cached"));
    }

    /// Runs `write` without the bar in the way.
    pub fn suspend<T>(&self, write: impl FnOnce() -> T) -> T {
        self.bar.suspend(write)
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
