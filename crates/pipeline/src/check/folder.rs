//! The files beside a document on disk.

use std::io::{self, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::files::Files;
use crate::input_file::{check_file, open_file};
use crate::memory;

/// The folder of a document, as a source of [`Files`].
pub struct Folder(pub PathBuf);

impl Files for Folder {
    fn length(&self, path: &Path) -> io::Result<u64> {
        check_file(&self.0.join(path))
    }

    fn read(&self, path: &Path, range: Range<u64>) -> io::Result<Vec<u8>> {
        let (mut file, _) = open_file(&self.0.join(path))?;
        file.seek(SeekFrom::Start(range.start))?;
        let mut bytes = memory::filled(usize::try_from(range.end - range.start).map_err(io::Error::other)?, 0)?;
        file.read_exact(&mut bytes)?;
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests;
