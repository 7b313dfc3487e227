//! Parts of the files beside a document.

use std::io::{self, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::check::Files;
use crate::input_file::{check_file, open_file};
use crate::memory;

/// The folder that a document lies in.
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
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn parts_of_ordinary_files_are_read_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("file"), "0123456789").unwrap();
        let files = Folder(folder.path().to_owned());
        let file = Path::new("file");
        assert_eq!(files.length(file).unwrap(), 10);
        assert_eq!(files.read(file, 3..7).unwrap(), b"3456");
        assert_eq!(files.read(file, 7..11).unwrap_err().kind(), io::ErrorKind::UnexpectedEof);
        for path in [".", "no such file"].map(Path::new) {
            assert!(files.length(path).is_err() && files.read(path, 0..1).is_err());
        }
    }
}
