//! Many at once, one after the other.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::{Mutex, mpsc};
use std::thread;

/// Calls `make` with 0 to `count` on `workers` threads, and `take` with what it returns in order, on this one. At most
/// twice as many as there are workers are begun before the first of them is taken, so that little waits in memory.
///
/// # Errors
/// The first of `take`, after which nothing is taken any more.
pub fn in_order<R: Send, E>(
    count: usize,
    workers: usize,
    make: impl Fn(usize) -> R + Sync,
    mut take: impl FnMut(usize, R) -> Result<(), E>,
) -> Result<(), E> {
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
            // Fails only when all workers are gone, and then nothing is made either.
            let _ = tickets.send(*index);
        });
        begun.by_ref().take(2 * workers).for_each(drop);
        let mut early = BTreeMap::new();
        for wanted in 0..count {
            let result = loop {
                if let Some(result) = early.remove(&wanted) {
                    break result;
                }
                // The workers wait for tickets or work; none is gone.
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
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::time::Duration;

    use super::*;

    #[test]
    fn what_is_made_is_taken_in_order_and_little_waits() {
        for workers in [0, 1, 2, 5] {
            let taken = AtomicUsize::new(0);
            let (mut found, begun_before) = (Vec::new(), AtomicUsize::new(0));
            let make = |index: usize| {
                begun_before.fetch_max(index - taken.load(Ordering::SeqCst).min(index), Ordering::SeqCst);
                thread::sleep(Duration::from_micros((index as u64 * 7919) % 300));
                index * 2
            };
            let ended = in_order(40, workers, make, |index, result| {
                found.push((index, result));
                taken.store(index, Ordering::SeqCst);
                Ok::<(), ()>(())
            });
            assert_eq!(ended, Ok(()));
            assert_eq!(found, (0..40).map(|i| (i, 2 * i)).collect::<Vec<_>>());
            assert!(begun_before.load(Ordering::SeqCst) <= 2 * workers.max(1));
        }
        assert_eq!(in_order(0, 2, |_| (), |_, ()| Err("there is none")), Ok(()));
    }

    #[test]
    fn an_error_ends_it() {
        let made = AtomicUsize::new(0);
        let make = |index| {
            made.fetch_add(1, Ordering::SeqCst);
            index
        };
        assert_eq!(in_order(1000, 2, make, |index, _| if index == 5 { Err(index) } else { Ok(()) }), Err(5));
        assert!(made.load(Ordering::SeqCst) <= 5 + 4);
    }

    #[test]
    fn a_panic_ends_it() {
        let run = || in_order(10, 2, |index| assert_ne!(index, 3, "made to fail"), |_, ()| Ok::<(), ()>(()));
        assert!(catch_unwind(run).is_err());
    }
}
