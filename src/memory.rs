//! Asking for memory before it is taken. Rust ends the process when an allocation fails, and with it the bakes of all other
//! assets, so whatever grows with an input is asked for here first.

use std::hint::black_box;
use std::io;

/// Memory that the system refuses to give.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "expected {} MiB of free memory, found less; bake fewer assets at a time (`--threads 1`), scale the images down, or \
     raise the limit on memory",
    bytes.div_ceil(1 << 20)
)]
pub struct OutOfMemory {
    /// Bytes that were asked for.
    pub bytes: u64,
}

impl From<OutOfMemory> for io::Error {
    fn from(error: OutOfMemory) -> Self {
        Self::new(io::ErrorKind::OutOfMemory, error)
    }
}

/// Requests below this many bytes are not asked for: there are many, and none is what fills the memory.
const SMALL: u64 = 1 << 20;

/// Bytes that must stay free beside a large request, for all the small ones that follow.
const SPARE: u64 = 64 << 20;

/// Checks that `bytes` can be allocated at once and that some memory is left then.
///
/// A system that promises more memory than there is (overcommit) never refuses; limits on the address space (`ulimit -v`)
/// and systems that count what they promise do.
///
/// # Errors
/// [`OutOfMemory`].
pub fn check(bytes: u64) -> Result<(), OutOfMemory> {
    if bytes < SMALL {
        return Ok(());
    }
    let refused = OutOfMemory { bytes };
    let wanted = usize::try_from(bytes.saturating_add(bytes.min(SPARE))).map_err(|_| refused)?;
    let mut probe: Vec<u8> = Vec::new();
    probe.try_reserve_exact(wanted).map_err(|_| refused)?;
    // Compilers may leave out an allocation that nobody looks at.
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

/// Returns an empty vector with room for `len` items.
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
mod tests {
    use super::*;

    #[test]
    fn more_than_an_address_space_is_refused() {
        assert_eq!(check(u64::MAX), Err(OutOfMemory { bytes: u64::MAX }));
        assert!(filled(usize::MAX / 2, 0u64).is_err());
        assert!(with_capacity::<u8>(usize::MAX).is_err());
    }

    #[test]
    fn what_fits_is_given() {
        assert_eq!(filled(3, 7u8), Ok(vec![7; 3]));
        assert_eq!(filled(2 << 20, 7u8).map(|v| v.len()), Ok(2 << 20));
        assert!(with_capacity::<u32>(1 << 20).is_ok_and(|v| v.is_empty() && v.capacity() >= 1 << 20));
    }

    #[test]
    fn the_message_names_mebibytes() {
        assert!(
            OutOfMemory { bytes: (3 << 20) + 1 }.to_string().starts_with("expected 4 MiB of free memory, found less;")
        );
    }
}
