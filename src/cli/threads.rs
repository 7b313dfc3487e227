//! The threads of all commands.

use std::env;
use std::error::Error;
use std::io::Write;
use std::num::NonZero;
use std::thread;

use rayon::{ThreadPoolBuildError, ThreadPoolBuilder};

/// The variable that rayon reads; `--threads` wins over it.
const VARIABLE: &str = "RAYON_NUM_THREADS";

/// The most threads for each core. More threads are slower: on two cores a small asset took 0.26 s with two threads,
/// 6.5 s with 1024 and more than a minute with 4096.
const MOST_PER_CORE: usize = 4;

/// The number of threads that is accepted on every machine.
const ALWAYS_ALLOWED: usize = 64;

/// The threads cannot be started.
#[derive(Debug, thiserror::Error)]
#[error("expected to start {count} threads, found: {error}; ask for fewer with --threads")]
pub struct ThreadsError {
    /// How many.
    count: usize,
    /// The error of the thread pool.
    error: ThreadPoolBuildError,
}

/// Starts the number of threads that `flag` names. If `flag` is 0, the variable names the number, else there is one
/// thread for each core. Warns if that is fewer than the user asks for.
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
        // A second pool in one process is refused. The first pool stays, and the bytes do not depend on it.
        Err(error) if error.source().is_some() => Err(ThreadsError { count, error }),
        _ => Ok(()),
    }
}
