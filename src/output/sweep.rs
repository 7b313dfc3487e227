//! Temporary files that a killed run left behind.

use std::ffi::OsStr;
use std::fs::{self, Metadata};
use std::path::Path;
use std::time::{Duration, SystemTime};

/// How the names of files begin that are being written.
pub(super) const UNFINISHED: &str = ".roughcast-";

/// Nobody writes a file for so long: its process was killed.
const UNFINISHED_AGE: Duration = Duration::from_secs(3600);

/// Returns whether the file called `name` was being written by a process that is gone. Its date may also lie that far in
/// the future: clocks that are wrong by more than that do not tell whether it is old.
pub fn is_abandoned(name: &OsStr, facts: &Metadata) -> bool {
    let is_old = |modified: SystemTime| {
        let age = modified.elapsed().unwrap_or_else(|error| error.duration());
        age > UNFINISHED_AGE
    };
    is_unfinished(name) && facts.modified().is_ok_and(is_old)
}

/// Removes abandoned files from `folder`.
pub(super) fn sweep(folder: &Path) {
    let unfinished = fs::read_dir(folder).into_iter().flatten().flatten().filter(|e| is_unfinished(&e.file_name()));
    for entry in unfinished {
        if entry.metadata().is_ok_and(|facts| is_abandoned(&entry.file_name(), &facts)) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

fn is_unfinished(name: &OsStr) -> bool {
    name.as_encoded_bytes().starts_with(UNFINISHED.as_bytes())
}
