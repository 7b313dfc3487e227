//! Opening and reading of input files. Every file that is named from outside is opened here. A pipe, a socket or a
//! device is refused, since reading it could wait forever. A file that is too large for memory is refused, too.

use std::fmt::{self, Display};
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, Read};
use std::path::Path;

use crate::digest::{Digest, digest_of};
use crate::memory;

/// Largest input file. No image within the limits on texels is as large.
const MAX_FILE_BYTES: u64 = 8 << 30;

/// Why a file that the user names cannot be read, and what to do.
pub struct Unreadable<'a>(pub &'a io::Error);

impl Display for Unreadable<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0.kind() {
            io::ErrorKind::NotFound => f.write_str("no such file; check the path"),
            io::ErrorKind::IsADirectory => f.write_str("a folder; name a file in it"),
            _ => write!(f, "{}; check the path", self.0),
        }
    }
}

/// Opens an ordinary file, or a link to one. Returns the file and its length.
///
/// # Errors
/// The system's error, or that the file is not ordinary, or larger than 8 GiB.
pub fn open_file(path: &Path) -> io::Result<(File, u64)> {
    // Opening a device may have side effects, so the file is checked before it is opened.
    check_file(path)?;
    let mut options = OpenOptions::new();
    options.read(true);
    do_not_wait(&mut options);
    let file = options.open(path)?;
    // Another file may have replaced the checked one.
    let length = length_of(&file.metadata()?)?;
    Ok((file, length))
}

/// Makes opening a pipe return at once instead of waiting for a writer. Reading of ordinary files is unchanged.
#[cfg(unix)]
fn do_not_wait(options: &mut OpenOptions) {
    use std::os::unix::fs::OpenOptionsExt;
    options.custom_flags(libc::O_NONBLOCK);
}

#[cfg(not(unix))]
fn do_not_wait(_: &mut OpenOptions) {}

/// Reads an ordinary file of at most 8 GiB, or the target of a link.
///
/// # Errors
/// The system's error, or that the file is not ordinary, is larger than 8 GiB, or does not fit into memory.
pub fn read_file(path: &Path) -> io::Result<Vec<u8>> {
    let (file, length) = open_file(path)?;
    let mut bytes = memory::with_capacity(usize::try_from(length).map_err(io::Error::other)?)?;
    // The limit holds also if another process appends to the file.
    file.take(MAX_FILE_BYTES).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Returns the digest and the length of a file that [`read_file`] may read. The file is not kept in memory: hashing 48
/// MB takes 15 ms in this way, and 40 ms if the file is first read into new memory.
///
/// # Errors
/// The system's error, or that the file is not ordinary, or larger than 8 GiB.
pub fn hash_file(path: &Path) -> io::Result<(Digest, u64)> {
    let (file, _) = open_file(path)?;
    digest_of(file.take(MAX_FILE_BYTES))
}

/// Returns whether the file at `path` has the digest `blake3`.
pub fn holds(path: &Path, blake3: Digest) -> bool {
    hash_file(path).is_ok_and(|(found, _)| found == blake3)
}

/// Checks that [`read_file`] may read the file. Returns its length.
///
/// # Errors
/// The system's error, or that the file is not ordinary, or larger than 8 GiB.
pub fn check_file(path: &Path) -> io::Result<u64> {
    length_of(&fs::metadata(path)?)
}

fn length_of(metadata: &Metadata) -> io::Result<u64> {
    if metadata.is_dir() {
        return Err(io::Error::new(io::ErrorKind::IsADirectory, "a folder"));
    }
    if !metadata.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "not an ordinary file"));
    }
    if metadata.len() > MAX_FILE_BYTES {
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, "larger than 8 GiB"));
    }
    Ok(metadata.len())
}

#[cfg(test)]
mod tests;
