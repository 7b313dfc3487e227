//! The farm: workers that take actions from one scheduler and share one store. The simulation goes from event to event.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

/// Assumptions about a farm. Times are in seconds, rates per second.
#[derive(Clone, Copy)]
pub struct Farm {
    pub workers: usize,
    /// Bytes that the store sends and receives in total.
    pub store: f64,
    /// Bytes that a worker sends or receives.
    pub link: f64,
    /// Actions that the scheduler assigns.
    pub dispatch: f64,
    /// Time that an action takes its worker besides its jobs.
    pub overhead: f64,
}

/// An action: what a worker does at once.
#[derive(Clone, Copy, Default)]
pub struct Action {
    /// Bytes that are fetched first.
    pub down: f64,
    /// Processor seconds.
    pub work: f64,
    /// Bytes that are stored afterwards.
    pub up: f64,
}

/// The result of a run.
#[derive(Clone, Copy)]
pub struct Outcome {
    /// Time until the last action is done.
    pub seconds: f64,
    /// Shares of that time in which the store, the scheduler and the workers were busy.
    pub workers: f64,
    pub links: f64,
    pub store: f64,
    pub scheduler: f64,
}

/// The next step of an action.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Step {
    Fetch,
    Work,
    Put,
    Done,
}

/// A time, as bits in the order of times. No time is negative.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Time(u64);

impl Time {
    fn new(seconds: f64) -> Self {
        Self(seconds.to_bits())
    }

    fn seconds(self) -> f64 {
        f64::from_bits(self.0)
    }
}

/// A server that serves one request at a time, first come, first served.
#[derive(Default)]
struct Queue {
    free: f64,
    busy: f64,
}

impl Queue {
    /// Returns when a request that arrives at `now` and takes `time` is done.
    fn serve(&mut self, now: f64, time: f64) -> f64 {
        self.busy += time;
        self.free = now.max(self.free) + time;
        self.free
    }
}

impl Farm {
    /// Runs `actions` in their order, as workers become free.
    pub fn run(&self, actions: impl Iterator<Item = Action>) -> Outcome {
        let (mut scheduler, mut store) = (Queue::default(), Queue::default());
        let mut events = BinaryHeap::with_capacity(self.workers);
        let mut idle: VecDeque<usize> = (0..self.workers).collect();
        let mut at_work = vec![Action::default(); self.workers];
        let mut actions = actions.peekable();
        let (mut now, mut busy, mut carried) = (0.0_f64, 0.0_f64, 0.0_f64);
        loop {
            while actions.peek().is_some() {
                let Some(worker) = idle.pop_front() else { break };
                at_work[worker] = actions.next().unwrap_or_default();
                let start = scheduler.serve(now, 1.0 / self.dispatch);
                events.push(Reverse((Time::new(start), worker, Step::Fetch)));
            }
            let Some(Reverse((time, worker, step))) = events.pop() else { break };
            now = time.seconds();
            let action = at_work[worker];
            // The store sends to many workers at once. No worker receives faster than its own link.
            let mut carry = |bytes: f64| {
                carried += bytes;
                if bytes > 0.0 { store.serve(now, bytes / self.store).max(now + bytes / self.link) } else { now }
            };
            let next = match step {
                Step::Fetch => (carry(action.down), Step::Work),
                Step::Work => {
                    busy += action.work + self.overhead;
                    (now + action.work + self.overhead, Step::Put)
                }
                Step::Put => (carry(action.up), Step::Done),
                Step::Done => {
                    idle.push_back(worker);
                    continue;
                }
            };
            events.push(Reverse((Time::new(next.0), worker, next.1)));
        }
        let share = |busy: f64| if now > 0.0 { busy / now } else { 0.0 };
        Outcome {
            seconds: now,
            workers: share(busy / self.workers as f64),
            links: share(carried / self.link / self.workers as f64),
            store: share(store.busy),
            scheduler: share(scheduler.busy),
        }
    }
}
