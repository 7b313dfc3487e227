//! The progress bar: on a terminal only.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// Steps per asset.
const STEPS: f32 = 1000.0;

/// A bar over assets, of which each moves it by its share.
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// For `assets` assets; hidden when `quiet` or when standard error is no terminal.
    pub fn new(assets: usize, quiet: bool) -> Self {
        if quiet {
            return Self { bar: ProgressBar::hidden() };
        }
        let bar = ProgressBar::new((assets as f32 * STEPS) as u64);
        let style = ProgressStyle::with_template("{elapsed_precise} [{bar:40}] {percent:>3} %  {msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
        bar.enable_steady_tick(Duration::from_millis(200));
        Self { bar }
    }

    /// Work on asset `index` (from 0) has reached `share` (0 to 1).
    pub fn set(&self, index: usize, share: f32, name: &str) {
        self.bar.set_position(((index as f32 + share) * STEPS) as u64);
        self.bar.set_message(name.to_owned());
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
