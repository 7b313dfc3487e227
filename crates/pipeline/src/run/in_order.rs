//! A parallel map whose results are consumed in input order.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::{Mutex, mpsc};
use std::thread;

/// Calls `make` with 0 to `count` on `workers` threads, and `take` with the results in order, on the calling thread. At
/// most twice as many calls as there are workers begin before the first of their results is taken, which bounds memory.
///
/// On a thread of a rayon pool, all calls run one after another on the calling thread. A pool thread that waited for
/// the workers here would be missing in the pool, and the workers need the pool: with all its threads waiting, none
/// would go on. Parallel work inside of `make` still runs in parallel.
///
/// # Errors
/// The first error of `take`, after which nothing is taken any more.
pub fn in_order<R: Send, E>(
    count: usize,
    workers: usize,
    make: impl Fn(usize) -> R + Sync,
    mut take: impl FnMut(usize, R) -> Result<(), E>,
) -> Result<(), E> {
    if rayon::current_thread_index().is_some() {
        return (0..count).try_for_each(|index| take(index, make(index)));
    }
    let workers = workers.clamp(1, count.max(1));
    let (tickets, waiting) = mpsc::channel::<usize>();
    let (results, made) = mpsc::channel();
    let waiting = Mutex::new(waiting);
    thread::scope(|scope| {
        for _ in 0..workers {
            let results = results.clone();
            let (make, waiting) = (&make, &waiting);
            scope.spawn(move || {
                let next = || waiting.lock().ok()?.recv().ok();
                while let Some(index) = next() {
                    let result = catch_unwind(AssertUnwindSafe(|| make(index)));
                    if results.send((index, result)).is_err() {
                        break;
                    }
                }
            });
        }
        // Dropped at the end of this closure, which ends the workers.
        let tickets = tickets;
        let mut begun = (0..count).inspect(|index| {
            // Sending fails only when all workers have ended, and then there are no more results either.
            let _ = tickets.send(*index);
        });
        begun.by_ref().take(2 * workers).for_each(drop);
        let mut early = BTreeMap::new();
        for wanted in 0..count {
            let result = loop {
                if let Some(result) = early.remove(&wanted) {
                    break result;
                }
                // All workers run until the tickets are dropped, so this receives.
                let Ok((index, result)) = made.recv() else { return Ok(()) };
                early.insert(index, result);
            };
            take(wanted, result.unwrap_or_else(|panic| resume_unwind(panic)))?;
            begun.next();
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests;
