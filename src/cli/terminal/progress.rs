//! The progress bar, which is shown on a terminal only.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::report::Counts;
use crate::run::Progress;
use crate::text::printable;

/// Steps per asset.
const STEPS: f32 = 1000.0;

/// A bar over assets, each of which moves the bar by its share.
pub struct ProgressLine {
    bar: ProgressBar,
    /// Steps that each asset has reached.
    reached: Vec<AtomicU64>,
    /// Whether the bar shows the counts of a server instead of names.
    is_counted: AtomicBool,
}

impl ProgressLine {
    /// Returns a bar over `assets` assets, which is hidden when `quiet` or when standard error is no terminal.
    pub fn new(assets: usize, quiet: bool) -> Self {
        let reached = (0..assets).map(|_| AtomicU64::new(0)).collect();
        if quiet {
            return Self { bar: ProgressBar::hidden(), reached, is_counted: AtomicBool::new(false) };
        }
        let bar = ProgressBar::new((assets as f32 * STEPS) as u64);
        let style = ProgressStyle::with_template("{elapsed_precise} [{bar:40}] {percent:>3} %  {msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
        bar.enable_steady_tick(Duration::from_millis(200));
        Self { bar, reached, is_counted: AtomicBool::new(false) }
    }

    /// Hides the bar while `write` runs.
    pub fn suspend<T>(&self, write: impl FnOnce() -> T) -> T {
        self.bar.suspend(write)
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for ProgressLine {
    fn advance(&self, index: usize, share: f32, name: &str) {
        let now = (share * STEPS) as u64;
        let before = self.reached.get(index).map_or(now, |reached| reached.fetch_max(now, Ordering::Relaxed));
        self.bar.inc(now.saturating_sub(before));
        if !self.is_counted.load(Ordering::Relaxed) {
            self.bar.set_message(printable(name).into_owned());
        }
    }

    fn count(&self, counts: Counts) {
        let Counts { queued, running, known, done, .. } = counts;
        self.is_counted.store(true, Ordering::Relaxed);
        self.bar.set_message(format!("{queued} queued, {running} running, {done} done, {known} of them cached"));
    }
}
