//! Removal of temporary files that killed runs left behind.

use std::ffi::OsStr;
use std::fs::{self, Metadata};
use std::path::Path;
use std::time::{Duration, SystemTime};

/// Prefix of the names of temporary files.
pub(super) const UNFINISHED: &str = ".roughcast-";

/// Age from which a temporary file counts as abandoned: no write takes that long.
const UNFINISHED_AGE: Duration = Duration::from_secs(3600);

/// Returns whether the file `name` is a temporary file that its process has abandoned: its date differs from the clock
/// by more than `UNFINISHED_AGE`. Dates in the future count too, since they come from wrong clocks and say nothing
/// about age.
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
