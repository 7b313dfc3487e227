//! Checks that memory is available before it is allocated. Rust ends the process when an allocation fails, and with it
//! the bakes of all other assets. Every allocation that grows with an input is therefore checked here first.

use std::hint::black_box;
use std::io;
use std::sync::OnceLock;

/// Memory that the system refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "expected {} MiB of free memory, found less; bake fewer assets at a time (`--threads 1`), scale the images down, or \
     raise the limit on memory",
    bytes.div_ceil(1 << 20)
)]
#[non_exhaustive]
pub struct OutOfMemory {
    /// Bytes that were asked for.
    pub bytes: u64,
}

impl From<OutOfMemory> for io::Error {
    fn from(error: OutOfMemory) -> Self {
        Self::new(io::ErrorKind::OutOfMemory, error)
    }
}

/// Requests below this many bytes are not checked: there are many, and none of them fills the memory.
const SMALL: u64 = 1 << 20;

/// Bytes that must stay free besides a large request, for the small requests that follow and for other threads. The
/// allocator of Linux takes this much address space at once for the small requests of one thread.
const SPARE: u64 = 64 << 20;

/// A function that returns how many bytes the process may still take of its address space, or None without a limit.
pub type AddressSpace = fn() -> Option<u64>;

static ADDRESS_SPACE: OnceLock<AddressSpace> = OnceLock::new();

/// Sets how checks learn how much address space is left: only the system knows it, and this crate asks no system. The
/// first call counts.
pub fn watch_address_space(left: AddressSpace) {
    ADDRESS_SPACE.get_or_init(|| left);
}

/// Checks that `bytes` can be allocated at once and that some memory is then left.
///
/// A system that promises more memory than there is (overcommit) never refuses. A limit on the address space (`ulimit
/// -v`) refuses, and so does a system that counts its promises. The limit is compared first: a trial request that takes
/// nearly all that is left would make small requests of other threads fail meanwhile, and these end the process.
///
/// # Errors
/// [`OutOfMemory`].
pub fn check(bytes: u64) -> Result<(), OutOfMemory> {
    if bytes < SMALL {
        return Ok(());
    }
    let refused = OutOfMemory { bytes };
    let left = ADDRESS_SPACE.get().and_then(|left| left());
    if left.is_some_and(|left| left < bytes.saturating_add(SPARE)) {
        return Err(refused);
    }
    let wanted = usize::try_from(bytes.saturating_add(bytes.min(SPARE))).map_err(|_| refused)?;
    let mut probe: Vec<u8> = Vec::new();
    probe.try_reserve_exact(wanted).map_err(|_| refused)?;
    // Without this, the compiler may leave out an allocation that is not used.
    black_box(&mut probe);
    Ok(())
}

/// Returns `len` copies of `value`.
///
/// # Errors
/// [`OutOfMemory`].
pub fn filled<T: Clone>(len: usize, value: T) -> Result<Vec<T>, OutOfMemory> {
    check_items::<T>(len)?;
    Ok(vec![value; len])
}

/// Returns an empty vector with capacity for `len` items.
///
/// # Errors
/// [`OutOfMemory`].
pub fn with_capacity<T>(len: usize) -> Result<Vec<T>, OutOfMemory> {
    check_items::<T>(len)?;
    let mut items = Vec::new();
    items.try_reserve_exact(len).map_err(|_| OutOfMemory { bytes: bytes_of::<T>(len) })?;
    Ok(items)
}

fn check_items<T>(len: usize) -> Result<(), OutOfMemory> {
    check(bytes_of::<T>(len))
}

fn bytes_of<T>(len: usize) -> u64 {
    (len as u64).saturating_mul(size_of::<T>() as u64)
}

#[cfg(test)]
mod tests;
