//! Which errors of the system may be gone at the next try.

use std::io;

/// Returns whether an error of reading or writing may be gone at the next try: something was busy, full, broken or away, and
/// nothing was missing, forbidden or wrong.
pub fn is_passing(error: &io::Error) -> bool {
    use io::ErrorKind as Kind;
    let is_passing_kind = matches!(
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
            // A disk with errors is mounted anew without the right to write.
            | Kind::ReadOnlyFilesystem
            // A disk of another machine, or of a process, that is away.
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
    is_passing_kind || error.raw_os_error().is_some_and(|code| CODES.contains(&code))
}

/// Returns whether an error of writing may be gone at the next try. An output folder that was there and is gone can be made
/// again.
pub fn is_passing_write(error: &io::Error) -> bool {
    is_passing(error) || error.kind() == io::ErrorKind::NotFound
}

/// Errors of the system that [`io::ErrorKind`] has no name for: EIO, ENXIO, ENODEV, ENFILE and EMFILE, whose numbers are the
/// same on all Unix systems, and ENOLCK.
#[cfg(unix)]
const CODES: &[i32] = &[5, 6, 19, 23, 24, if cfg!(any(target_os = "linux", target_os = "android")) { 37 } else { 77 }];

/// Too many open files, a device that is not ready, a checksum of the disk, files and regions that others have locked, a
/// network share that is gone, an error of the device.
#[cfg(windows)]
const CODES: &[i32] = &[4, 21, 23, 32, 33, 55, 64, 1117];

#[cfg(not(any(unix, windows)))]
const CODES: &[i32] = &[];

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors as systems report them. A disk that fails need not be at hand.
    #[cfg(target_os = "linux")]
    #[test]
    fn what_may_be_gone_at_the_next_try_is_told_from_what_stays() {
        let passing = [
            ("EINTR", 4),
            ("EIO", 5),
            ("ENXIO", 6),
            ("EAGAIN", 11),
            ("ENOMEM", 12),
            ("EBUSY", 16),
            ("ENODEV", 19),
            ("ENFILE", 23),
            ("EMFILE", 24),
            ("ETXTBSY", 26),
            ("ENOSPC", 28),
            ("EROFS", 30),
            ("EDEADLK", 35),
            ("ENOLCK", 37),
            ("ENETDOWN", 100),
            ("ENETUNREACH", 101),
            ("ECONNABORTED", 103),
            ("ECONNRESET", 104),
            ("ENOTCONN", 107),
            ("ETIMEDOUT", 110),
            ("ECONNREFUSED", 111),
            ("EHOSTUNREACH", 113),
            ("ESTALE", 116),
            ("EDQUOT", 122),
        ];
        for (name, code) in passing {
            let error = io::Error::from_raw_os_error(code);
            assert!(is_passing(&error) && is_passing_write(&error), "{name}: {error:?}");
        }
        let lasting = [
            ("EPERM", 1),
            ("EACCES", 13),
            ("EEXIST", 17),
            ("ENOTDIR", 20),
            ("EISDIR", 21),
            ("EINVAL", 22),
            ("EFBIG", 27),
            ("ENAMETOOLONG", 36),
            ("ELOOP", 40),
        ];
        for (name, code) in lasting {
            let error = io::Error::from_raw_os_error(code);
            assert!(!is_passing(&error) && !is_passing_write(&error), "{name}: {error:?}");
        }
        // A source that is missing stays missing; an output folder is made again.
        let missing = io::Error::from_raw_os_error(2);
        assert!(!is_passing(&missing) && is_passing_write(&missing));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_device_may_have_room_at_the_next_try() {
        use std::io::Write;
        let mut full = std::fs::File::options().write(true).open("/dev/full").expect("Linux has it");
        let error = full.write_all(b"bytes").expect_err("the device is always full");
        assert!(is_passing(&error), "{error:?}");
    }
}
