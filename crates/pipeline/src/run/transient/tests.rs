use super::*;

/// Uses the error numbers of Linux, so that no disk has to fail.
#[cfg(target_os = "linux")]
#[test]
fn separates_transient_from_permanent_errors() {
    let transient = [
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
    for (name, code) in transient {
        let error = io::Error::from_raw_os_error(code);
        assert!(is_transient(&error) && is_transient_write(&error), "{name}: {error:?}");
    }
    let permanent = [
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
    for (name, code) in permanent {
        let error = io::Error::from_raw_os_error(code);
        assert!(!is_transient(&error) && !is_transient_write(&error), "{name}: {error:?}");
    }
    // A source that is missing stays missing; an output folder is made again.
    let missing = io::Error::from_raw_os_error(2);
    assert!(!is_transient(&missing) && is_transient_write(&missing));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device_is_a_transient_error() {
    use std::io::Write;
    let mut full = std::fs::File::options().write(true).open("/dev/full").expect("Linux has it");
    let error = full.write_all(b"bytes").expect_err("the device is always full");
    assert!(is_transient(&error), "{error:?}");
}
