//! The threads that all commands work with.

use std::env;
use std::error::Error;
use std::io::Write;
use std::num::NonZero;
use std::thread;

use rayon::{ThreadPoolBuildError, ThreadPoolBuilder};

/// The variable that rayon goes by; `--threads` wins over it.
const VARIABLE: &str = "RAYON_NUM_THREADS";

/// The most threads for each core. More only get in each other's way: on two cores a small asset took 0.26 s with two
/// threads, 6.5 s with 1024 and more than a minute with 4096.
const MOST_PER_CORE: usize = 4;

/// As many threads as any machine may be asked for.
const ALWAYS_ALLOWED: usize = 64;

/// The threads cannot be had.
#[derive(Debug, thiserror::Error)]
#[error("expected to start {count} threads, found: {error}; ask for fewer with --threads")]
pub struct ThreadsError {
    /// How many.
    count: usize,
    /// What the system says.
    error: ThreadPoolBuildError,
}

/// Starts as many threads as `flag` asks for, or the variable where `flag` is 0, or one for each core. Warns when they are
/// fewer than asked for.
///
/// # Errors
/// [`ThreadsError`] when the system refuses them.
pub fn start(flag: usize, err: &mut dyn Write) -> Result<(), ThreadsError> {
    let cores = thread::available_parallelism().map_or(1, NonZero::get);
    let most = (MOST_PER_CORE * cores).max(ALWAYS_ALLOWED);
    let (name, asked) = match flag {
        0 => (VARIABLE, env::var(VARIABLE).ok().and_then(|number| number.parse().ok()).unwrap_or(0)),
        flag => ("--threads", flag),
    };
    if asked > most {
        let _ = writeln!(
            err,
            "warning: {name}: expected at most {most} threads on {cores} core(s), found {asked}; {most} bake the same bytes"
        );
    }
    let count = if asked == 0 { cores } else { asked.min(most) };
    match ThreadPoolBuilder::new().num_threads(count).build_global() {
        // A second pool in one process is refused; the first one stays, and the bytes are the same.
        Err(error) if error.source().is_some() => Err(ThreadsError { count, error }),
        _ => Ok(()),
    }
}
