//! The memory budget of jobs that are baked in parallel.

use std::io::BufReader;
use std::path::Path;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use imagesize::ImageSize;

use crate::input_file::open_file;
use crate::material::kept_bytes;
use crate::run::job::Job;
use crate::settings::Profile;

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
/// another, so the largest map decides: its images and the levels that are kept of it. A material of three images may
/// have a base colour that is decoded, too, and lobes with a reflectance; with both, 4096 x 4096 texels take 530 MB
/// instead of 400 MB.
fn memory(job: &Job) -> u64 {
    let sizes = job.inputs.iter().filter_map(|input| size(&input.path));
    let images: Vec<u64> = sizes.map(|size| (size.width as u64).saturating_mul(size.height as u64)).collect();
    // The images inside a document, at two bytes a texel.
    let inside = job.inputs.iter().find(|input| input.path == job.source).map_or(0, |input| input.bytes / 2);
    // A wrong header may claim any number.
    let largest = images.iter().copied().max().unwrap_or(0).max(inside).min(1 << 40);
    let may_have_reflectance = images.is_empty() || images.len() > 2;
    let image_bytes = if may_have_reflectance { 12 } else { 5 };
    let has_pyramid = job.settings.profile.is_some_and(Profile::has_pyramid);
    kept_bytes(largest, job.settings.rdo.is_some(), has_pyramid) + image_bytes * largest
}

/// Returns the size of an image from its header; `None` for every other file.
fn size(path: &Path) -> Option<ImageSize> {
    let (file, _) = open_file(path).ok()?;
    imagesize::reader_size(BufReader::new(file)).ok()
}

#[cfg(test)]
mod tests;
