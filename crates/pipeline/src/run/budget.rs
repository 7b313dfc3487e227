//! The memory budget of jobs that are baked in parallel.

use std::io::BufReader;
use std::path::Path;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use imagesize::ImageSize;

use crate::input_file::open_file;
use crate::material::kept_bytes;
use crate::run::job::{Job, JobInput};

/// The memory that all running jobs may take together. It bounds memory on machines with many cores, where one job per
/// thread would need more memory than the machine has. Threads without a job help with the jobs of other threads.
pub struct MemoryBudget {
    total: u64,
    free: Mutex<u64>,
    left: Condvar,
}

/// The smallest budget in bytes: ten maps of 4096^2 stay below 2 GiB, together with what all jobs share.
const LEAST: u64 = 1 << 30;

/// Bytes for each thread: a map of 2048^2 takes 105 MB.
const PER_THREAD: u64 = 128 << 20;

impl MemoryBudget {
    /// Returns the budget for jobs on `threads` threads.
    pub fn new(threads: usize) -> Self {
        let total = LEAST.max(PER_THREAD * threads as u64);
        Self { total, free: Mutex::new(total), left: Condvar::new() }
    }

    /// Waits until the budget has memory for `job`. A job that is larger than the whole budget runs alone. The calling
    /// thread must not be one that running jobs need.
    pub fn acquire(&self, job: &Job) -> Permit<'_> {
        self.take(memory(job))
    }

    /// Waits until no other job is baked.
    pub fn acquire_all(&self) -> Permit<'_> {
        self.take(self.total)
    }

    fn take(&self, bytes: u64) -> Permit<'_> {
        let bytes = bytes.min(self.total);
        let is_full = |free: &mut u64| *free < bytes;
        *self.left.wait_while(self.free(), is_full).unwrap_or_else(PoisonError::into_inner) -= bytes;
        Permit { budget: self, bytes }
    }

    fn free(&self) -> MutexGuard<'_, u64> {
        self.free.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The part of the budget that a job holds until the permit is dropped.
pub struct Permit<'r> {
    budget: &'r MemoryBudget,
    bytes: u64,
}

impl Permit<'_> {
    /// Returns whether no other job runs while the permit is held.
    pub fn is_alone(&self) -> bool {
        self.bytes == self.budget.total
    }
}

impl Drop for Permit<'_> {
    fn drop(&mut self) {
        *self.budget.free() += self.bytes;
        self.budget.left.notify_all();
    }
}

/// Estimates the memory that a bake of `job` takes at the default quality. The maps of a job are baked one after
/// another, so the largest map decides: its images and the levels that are kept of it.
fn memory(job: &Job) -> u64 {
    let texels = |input: &JobInput| match size(&input.path) {
        Some(size) => (size.width as u64).saturating_mul(size.height as u64),
        // The images inside a document, at two bytes a texel.
        None if input.path == job.source => input.bytes / 2,
        None => 0,
    };
    // A wrong header may claim any number.
    let largest = job.inputs.iter().map(texels).max().unwrap_or(0).min(1 << 40);
    kept_bytes(largest, job.settings.rdo.is_some()) + 5 * largest
}

/// Returns the size of an image from its header; `None` for every other file.
fn size(path: &Path) -> Option<ImageSize> {
    let (file, _) = open_file(path).ok()?;
    imagesize::reader_size(BufReader::new(file)).ok()
}

#[cfg(test)]
mod tests;
