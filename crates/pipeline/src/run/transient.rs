//! The transient errors of the system: the next try may succeed.

use std::io;

/// Returns whether an error of reading or writing is transient: something was busy, full, broken or away, and nothing
/// was missing, forbidden or wrong.
pub fn is_transient(error: &io::Error) -> bool {
    use io::ErrorKind as Kind;
    let is_transient_kind = matches!(
        error.kind(),
        // Busy.
        Kind::WouldBlock
            | Kind::TimedOut
            | Kind::Interrupted
            | Kind::ResourceBusy
            | Kind::ExecutableFileBusy
            | Kind::Deadlock
            // Full.
            | Kind::StorageFull
            | Kind::QuotaExceeded
            | Kind::WriteZero
            | Kind::OutOfMemory
            // The system mounts a disk with errors again as read-only.
            | Kind::ReadOnlyFilesystem
            // A disk of another machine or of a process is away.
            | Kind::StaleNetworkFileHandle
            | Kind::NetworkDown
            | Kind::NetworkUnreachable
            | Kind::HostUnreachable
            | Kind::NotConnected
            | Kind::ConnectionRefused
            | Kind::ConnectionReset
            | Kind::ConnectionAborted
            | Kind::BrokenPipe
    );
    is_transient_kind || error.raw_os_error().is_some_and(|code| CODES.contains(&code))
}

/// Returns whether an error of writing is transient. An output folder that was removed can be made again.
pub fn is_transient_write(error: &io::Error) -> bool {
    is_transient(error) || error.kind() == io::ErrorKind::NotFound
}

/// Errors of the system that [`io::ErrorKind`] has no name for: EIO, ENXIO, ENODEV, ENFILE and EMFILE, whose numbers
/// are equal on all Unix systems, and ENOLCK.
#[cfg(unix)]
const CODES: &[i32] = &[5, 6, 19, 23, 24, if cfg!(any(target_os = "linux", target_os = "android")) { 37 } else { 77 }];

/// Too many open files, a device that is not ready, a wrong checksum of the disk, files and regions that others have
/// locked, a network share that is gone, an error of the device.
#[cfg(windows)]
const CODES: &[i32] = &[4, 21, 23, 32, 33, 55, 64, 1117];

#[cfg(not(any(unix, windows)))]
const CODES: &[i32] = &[];

#[cfg(test)]
mod tests;
