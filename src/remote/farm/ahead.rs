//! Jobs on their way: sent and fetched by threads of their own, ahead of whoever publishes them in order.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError, mpsc};
use std::thread;

use tokio::sync::watch;

use super::error::RemoteError;
use super::group::{Group, groups};
use super::server::Remote;
use crate::remote::{Counts, Errand, JobFailure, Origin, Outcome, Wait};

impl Remote {
    /// Runs the jobs of `errand` while `then` runs, which may wait for each. When `then` ends, what is left is given up.
    pub fn ahead<R>(&self, errand: &Errand<'_>, then: impl FnOnce(Wait<'_>) -> R) -> R {
        let (mut senders, mut receivers) = (HashMap::new(), HashMap::new());
        for (index, _) in &errand.jobs {
            let (sender, receiver) = mpsc::channel::<Outcome>();
            senders.insert(*index, sender);
            receivers.insert(*index, Mutex::new(receiver));
        }
        self.client.count(|counts| counts.queued += errand.jobs.len() as u64);
        let groups = groups(&errand.jobs);
        let threads = self.options.jobs.clamp(1, groups.len().max(1));
        let queue = Mutex::new((groups.into_iter(), senders));
        let (stop, stopped) = watch::channel(false);
        thread::scope(|scope| {
            let work = || {
                let next = || {
                    let mut queue = queue.lock().unwrap_or_else(PoisonError::into_inner);
                    let group = if *stopped.borrow() { None } else { queue.0.next() }?;
                    let senders: Vec<_> = group.iter().map(|(index, _)| queue.1.remove(index)).collect();
                    Some((group, senders))
                };
                while let Some((group, senders)) = next() {
                    let outcomes = self.runtime.block_on(self.group(errand, &group, stopped.clone()));
                    for (sender, outcome) in senders.into_iter().zip(outcomes) {
                        // Nobody waits for what was given up.
                        let _ = sender.map(|sender| sender.send(outcome));
                    }
                }
            };
            (0..threads).for_each(|_| drop(scope.spawn(work)));
            // However `then` ends, the threads end, too.
            let _stop = Stop(stop);
            then(&|index| {
                let receiver = receivers.get(&index)?.lock().unwrap_or_else(PoisonError::into_inner);
                // Without a sender its thread has panicked, which the end of the scope tells.
                Some(receiver.recv().unwrap_or_else(|_| Err(JobFailure::from(&RemoteError::Cancelled))))
            })
        })
    }

    /// What becomes of the jobs of a group.
    async fn group(&self, errand: &Errand<'_>, group: &Group<'_>, mut stopped: watch::Receiver<bool>) -> Vec<Outcome> {
        let stage = Mutex::new(Stage::Queued);
        let advance = |to: Stage| {
            let mut stage = stage.lock().unwrap_or_else(PoisonError::into_inner);
            if *stage != to {
                self.client.count(|counts| {
                    *stage.number(counts) -= group.len() as u64;
                    *to.number(counts) += group.len() as u64;
                });
                *stage = to;
                (errand.changed)(self.counts());
            }
        };
        let running = || advance(Stage::Running);
        let outcomes = tokio::select! {
            outcomes = self.outcomes(errand, group, &running) => outcomes,
            _ = stopped.wait_for(|stopped| *stopped) => {
                group.iter().map(|_| Err(JobFailure::from(&RemoteError::Cancelled))).collect()
            }
        };
        let known = outcomes.iter().filter(|outcome| matches!(outcome, Ok(Origin::Cached))).count();
        self.client.count(|counts| counts.known += known as u64);
        advance(Stage::Done);
        outcomes
    }
}

/// Tells threads to end when it is dropped.
struct Stop(watch::Sender<bool>);

impl Drop for Stop {
    fn drop(&mut self) {
        let _ = self.0.send(true);
    }
}

/// How far jobs are.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Stage {
    Queued,
    Running,
    Done,
}

impl Stage {
    /// How many jobs are there.
    fn number(self, counts: &mut Counts) -> &mut u64 {
        match self {
            Self::Queued => &mut counts.queued,
            Self::Running => &mut counts.running,
            Self::Done => &mut counts.done,
        }
    }
}
