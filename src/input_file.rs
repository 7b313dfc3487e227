//! Opening and reading input files. Every file that somebody else names is opened here: a pipe, a socket or a device in the
//! place of a file is refused, where reading it could wait for ever, and so is what is too long to be held.

use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, Read};
use std::path::Path;

use crate::digest::{Digest, digest_of};
use crate::memory;

/// Largest input file: no map within the limits on texels is as large.
const MAX_FILE_BYTES: u64 = 8 << 30;

/// Opens an ordinary file, or a link to one; returns it with its length.
///
/// # Errors
/// The system's, or that it is no ordinary file, or larger than 8 GiB.
pub fn open_file(path: &Path) -> io::Result<(File, u64)> {
    // Opening a device may have effects of its own, so it is not opened at all.
    check_file(path)?;
    let mut options = OpenOptions::new();
    options.read(true);
    do_not_wait(&mut options);
    let file = options.open(path)?;
    // Something else may have come in the place of what was looked at.
    let length = length_of(&file.metadata()?)?;
    Ok((file, length))
}

/// Makes opening a pipe return at once instead of waiting for a writer. Ordinary files are read as ever.
#[cfg(unix)]
fn do_not_wait(options: &mut OpenOptions) {
    use std::os::unix::fs::OpenOptionsExt;
    options.custom_flags(libc::O_NONBLOCK);
}

#[cfg(not(unix))]
fn do_not_wait(_: &mut OpenOptions) {}

/// Reads an ordinary file of at most 8 GiB, or the one that a link leads to.
///
/// # Errors
/// The system's, that it is no ordinary file, that it is larger than 8 GiB, or that there is no memory for it.
pub fn read_file(path: &Path) -> io::Result<Vec<u8>> {
    let (file, length) = open_file(path)?;
    let mut bytes = memory::with_capacity(usize::try_from(length).map_err(io::Error::other)?)?;
    // Not past the end of a file that someone adds to.
    file.take(MAX_FILE_BYTES).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Returns the digest of a file that [`read_file`] may read, and its length. The file is not held: hashing 48 MB that
/// way takes 15 ms, after reading them into new memory 40.
///
/// # Errors
/// The system's, that it is no ordinary file, or that it is larger than 8 GiB.
pub fn hash_file(path: &Path) -> io::Result<(Digest, u64)> {
    let (file, _) = open_file(path)?;
    digest_of(file.take(MAX_FILE_BYTES))
}

/// Returns whether the file at `path` has the bytes whose digest is `blake3`.
pub fn holds(path: &Path, blake3: Digest) -> bool {
    hash_file(path).is_ok_and(|(found, _)| found == blake3)
}

/// Checks that [`read_file`] may read the file; returns its length.
///
/// # Errors
/// The system's, that it is no ordinary file, or that it is larger than 8 GiB.
pub fn check_file(path: &Path) -> io::Result<u64> {
    length_of(&fs::metadata(path)?)
}

fn length_of(facts: &Metadata) -> io::Result<u64> {
    if !facts.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "not an ordinary file"));
    }
    if facts.len() > MAX_FILE_BYTES {
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, "larger than 8 GiB"));
    }
    Ok(facts.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ordinary_files_are_read_and_hashed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, b"what it holds").unwrap();
        assert_eq!(read_file(&path).unwrap(), b"what it holds");
        assert_eq!(hash_file(&path).unwrap(), (crate::digest::digest(b"what it holds"), 13));
        assert_eq!(check_file(&path).unwrap(), 13);
    }

    #[test]
    fn folders_and_what_is_not_there_are_errors() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(read_file(folder.path()).unwrap_err().kind(), io::ErrorKind::InvalidInput);
        assert_eq!(read_file(&folder.path().join("a")).unwrap_err().kind(), io::ErrorKind::NotFound);
    }

    /// A test that fails here hangs.
    #[test]
    #[cfg(unix)]
    fn sockets_devices_and_links_to_them_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let socket = folder.path().join("socket");
        let _listening = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        let link = folder.path().join("link");
        std::os::unix::fs::symlink("/dev/zero", &link).unwrap();
        for path in [&socket, &link, Path::new("/dev/null")] {
            assert_eq!(open_file(path).unwrap_err().kind(), io::ErrorKind::InvalidInput, "{}", path.display());
            assert!(hash_file(path).is_err() && read_file(path).is_err());
        }
    }

    #[test]
    fn what_is_longer_than_8_gib_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sparse");
        File::create(&path).unwrap().set_len(MAX_FILE_BYTES + 1).unwrap();
        assert_eq!(read_file(&path).unwrap_err().kind(), io::ErrorKind::FileTooLarge);
    }
}
