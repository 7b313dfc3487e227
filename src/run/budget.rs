//! Memory of jobs that are baked side by side.

use std::io::BufReader;
use std::path::Path;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use imagesize::ImageSize;

use crate::input_file::open_file;
use crate::material::kept_bytes;
use crate::run::job::{Job, JobInput};

/// What jobs that are baked at a time may take together. It bounds memory on machines with many cores, where a job per thread
/// would take more than there is; threads without a job of their own help with those of others.
pub struct MemoryBudget {
    total: u64,
    free: Mutex<u64>,
    left: Condvar,
}

/// Bytes that there are at least: with what all jobs share, ten maps of 4096^2 stay below 2 GiB.
const LEAST: u64 = 1 << 30;

/// Bytes for each thread: a map of 2048^2 takes 105 MB.
const PER_THREAD: u64 = 128 << 20;

impl MemoryBudget {
    /// For jobs on `threads` threads.
    pub fn new(threads: usize) -> Self {
        let total = LEAST.max(PER_THREAD * threads as u64);
        Self { total, free: Mutex::new(total), left: Condvar::new() }
    }

    /// Waits until there is room for `job`; one that is larger than all of it is alone. The calling thread must be none that
    /// jobs need to get on.
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

/// A job's part of a room, until this is dropped.
pub struct Permit<'r> {
    budget: &'r MemoryBudget,
    bytes: u64,
}

impl Permit<'_> {
    /// Whether no other job is baked meanwhile.
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

/// About what a bake of `job` takes at the default quality: its maps are baked one after another, and the largest takes
/// most, for its images and for what is kept of its levels.
fn memory(job: &Job) -> u64 {
    let texels = |input: &JobInput| match size(&input.path) {
        Some(size) => (size.width as u64).saturating_mul(size.height as u64),
        // Images inside of it, of two bytes a texel.
        None if input.path == job.source => input.bytes / 2,
        None => 0,
    };
    // A header that lies may claim any number.
    let largest = job.inputs.iter().map(texels).max().unwrap_or(0).min(1 << 40);
    kept_bytes(largest, job.settings.contains_key("rdo")) + 5 * largest
}

/// Returns the size of an image from its header; `None` for every other file.
fn size(path: &Path) -> Option<ImageSize> {
    let (file, _) = open_file(path).ok()?;
    imagesize::reader_size(BufReader::new(file)).ok()
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;
    use std::sync::atomic::{AtomicU64, Ordering};
    use std::thread;

    use serde_json::Map;

    use super::*;

    #[test]
    fn what_is_taken_at_a_time_is_bounded() {
        let budget = MemoryBudget { total: 100, free: Mutex::new(100), left: Condvar::new() };
        let (taken, most) = (AtomicU64::new(0), AtomicU64::new(0));
        thread::scope(|scope| {
            for job in 0..40 {
                let (budget, taken, most) = (&budget, &taken, &most);
                scope.spawn(move || {
                    let bytes = [10, 40, 60, 1000][job % 4];
                    let _seat = budget.take(bytes);
                    let now = taken.fetch_add(bytes.min(100), Ordering::SeqCst) + bytes.min(100);
                    most.fetch_max(now, Ordering::SeqCst);
                    thread::yield_now();
                    taken.fetch_sub(bytes.min(100), Ordering::SeqCst);
                });
            }
        });
        assert!(most.into_inner() <= 100);
        assert_eq!(*budget.free(), 100);
    }

    #[test]
    fn the_largest_image_counts() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        image::RgbImage::new(30, 20).save(path("small.png")).expect("a file");
        image::RgbImage::new(300, 200).save(path("large.png")).expect("a file");
        std::fs::write(path("mesh.bin"), vec![0; 1 << 20]).expect("a file");
        let input = |name: &str, bytes| JobInput { path: path(name), blake3: None, bytes };
        let inputs = |names: &[&str]| names.iter().map(|name| input(name, 1000)).collect();
        let job = |inputs| Job {
            id: crate::digest::digest(b""),
            source: path("a.gltf"),
            output: PathBuf::new(),
            settings: Map::new(),
            inputs,
            outputs: Vec::new(),
            cost: 0,
            command: Vec::new(),
        };
        assert_eq!(memory(&job(inputs(&["a.gltf"]))), 25 * 500);
        assert_eq!(memory(&job(inputs(&["a.gltf", "mesh.bin", "absent.png"]))), 25 * 500);
        assert_eq!(memory(&job(inputs(&["a.gltf", "small.png", "large.png"]))), 25 * 60_000);
    }

    /// Headers that lie or end early.
    #[test]
    fn no_file_makes_it_fail() {
        let mut png = std::io::Cursor::new(Vec::new());
        image::RgbImage::new(5, 7).write_to(&mut png, image::ImageFormat::Png).expect("a file");
        let starts: [&[u8]; 8] = [
            png.get_ref(),
            b"\xff\xd8\xff\xe0\0\x10JFIF\0\x01\xff\xc0\0\x11\x08\xff\xff\xff\xff",
            b"II*\0\xff\xff\xff\xff",
            b"RIFF\xff\xff\xff\xffWEBPVP8L\xff\xff\xff\xff",
            b"\x76\x2f\x31\x01\x02\0\0\0channels\0chlist\0\xff\xff\xff\xff",
            b"#?RADIANCE\n\n-Y 99999999999999999999 +X 1\n",
            b"\xabKTX 20\xbb\r\n\x1a\n\0\0\0\0\xff\xff\xff\xff\xff\xff\xff\xff",
            b"\0\0\x02\0\0\0\0\0\0\0\0\0\xff\xff\xff\xff\x18\0",
        ];
        for start in starts {
            for length in 0..start.len() {
                let mut bytes = start[..length].to_vec();
                let _ = imagesize::blob_size(&bytes);
                bytes.resize(4 * length, 0xff);
                let _ = imagesize::blob_size(&bytes);
            }
        }
    }
}
