//! Running of jobs in threads that send jobs and fetch results, ahead of the caller, who publishes results in order.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError, mpsc};
use std::thread;

use tokio::sync::watch;

use super::error::RemoteError;
use super::group::{Group, groups};
use super::server::Remote;
use crate::remote::{Counts, JobFailure, JobRequest, Origin, Outcome, Wait};

impl Remote {
    /// Runs the jobs of `request` while `then` runs, which may wait for each job. When `then` ends, the remaining jobs
    /// are cancelled.
    pub fn run_jobs<R>(&self, request: &JobRequest<'_>, then: impl FnOnce(Wait<'_>) -> R) -> R {
        let (mut senders, mut receivers) = (HashMap::new(), HashMap::new());
        for (index, _) in &request.jobs {
            let (sender, receiver) = mpsc::channel::<Outcome>();
            senders.insert(*index, sender);
            receivers.insert(*index, Mutex::new(receiver));
        }
        self.client.count(|counts| counts.queued += request.jobs.len() as u64);
        let groups = groups(&request.jobs);
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
                    let outcomes = self.runtime.block_on(self.run_group(request, &group, stopped.clone()));
                    for (sender, outcome) in senders.into_iter().zip(outcomes) {
                        // The receiver is gone if the caller has ended.
                        let _ = sender.map(|sender| sender.send(outcome));
                    }
                }
            };
            (0..threads).for_each(|_| drop(scope.spawn(work)));
            // The threads end however `then` ends, even by a panic.
            let _stop = Stop(stop);
            then(&|index| {
                let receiver = receivers.get(&index)?.lock().unwrap_or_else(PoisonError::into_inner);
                // If the sender is gone, its thread has panicked, and the end of the scope reports the panic.
                Some(receiver.recv().unwrap_or_else(|_| Err(JobFailure::from(&RemoteError::Cancelled))))
            })
        })
    }

    /// Runs the jobs of a group and returns their outcomes.
    async fn run_group(
        &self,
        request: &JobRequest<'_>,
        group: &Group<'_>,
        mut stopped: watch::Receiver<bool>,
    ) -> Vec<Outcome> {
        let stage = Mutex::new(Stage::Queued);
        let advance = |to: Stage| {
            let mut stage = stage.lock().unwrap_or_else(PoisonError::into_inner);
            if *stage != to {
                self.client.count(|counts| {
                    *stage.number(counts) -= group.len() as u64;
                    *to.number(counts) += group.len() as u64;
                });
                *stage = to;
                (request.changed)(self.counts());
            }
        };
        let running = || advance(Stage::Running);
        let outcomes = tokio::select! {
            outcomes = self.outcomes(request, group, &running) => outcomes,
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

/// Stops the threads when it is dropped.
struct Stop(watch::Sender<bool>);

impl Drop for Stop {
    fn drop(&mut self) {
        let _ = self.0.send(true);
    }
}

/// The stage that jobs have reached.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Stage {
    Queued,
    Running,
    Done,
}

impl Stage {
    /// Returns the number of jobs in this stage.
    fn number(self, counts: &mut Counts) -> &mut u64 {
        match self {
            Self::Queued => &mut counts.queued,
            Self::Running => &mut counts.running,
            Self::Done => &mut counts.done,
        }
    }
}
