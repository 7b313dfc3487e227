//! Wall time and processor time of a piece of work.

use std::time::{Duration, Instant};

use rustix::time::{ClockId, clock_gettime};
use serde_json::{Value, json};

/// Seconds that a piece of work takes.
pub struct Time {
    /// Wall time.
    pub wall: f64,
    /// Processor time of the process, all threads together.
    pub cpu: f64,
}

impl Time {
    /// Does `work` once and measures it.
    pub fn of<T>(work: impl FnOnce() -> T) -> (T, Self) {
        let (cpu, wall) = (processor(), Instant::now());
        let result = work();
        let wall = wall.elapsed().as_secs_f64();
        (result, Self { wall, cpu: processor() - cpu })
    }

    /// Returns the time as `run.py` reads it.
    pub fn to_json(&self) -> Value {
        json!({ "wall": self.wall, "cpu": self.cpu })
    }
}

fn processor() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32).as_secs_f64()
}
