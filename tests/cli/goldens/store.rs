//! Golden files on disk: a list of digests, and the smaller files by their digests.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

/// Largest file that is stored. Only the digest is known of larger ones.
pub const MAX_BYTES: usize = 24 << 10;

/// Returns the first 64 bits of the BLAKE3 digest of `bytes`, in hexadecimal.
pub fn digest(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex()[..16].to_owned()
}

/// Returns the digest of each output by its path.
pub fn read() -> BTreeMap<String, String> {
    let text = fs::read_to_string(list()).expect("tests/goldens.txt");
    text.lines().filter_map(|line| line.split_once("  ")).map(|(digest, path)| (path.into(), digest.into())).collect()
}

/// Returns the stored file of an output at `path` with this digest.
pub fn stored(path: &str, digest: &str) -> Option<Vec<u8>> {
    fs::read(folder().join(file_name(path, digest))).ok()
}

/// Writes the list and the files of `outputs`, and removes files that are no longer listed.
pub fn bless(outputs: &BTreeMap<String, Vec<u8>>) {
    let mut text = String::new();
    let mut names = BTreeSet::new();
    fs::create_dir_all(folder()).expect("a folder");
    for (path, bytes) in outputs {
        let digest = digest(bytes);
        text += &format!("{digest}  {path}\n");
        let name = file_name(path, &digest);
        if bytes.len() <= MAX_BYTES && names.insert(name.clone()) {
            fs::write(folder().join(name), bytes).expect("tests/goldens is writable");
        }
    }
    fs::write(list(), text).expect("tests/goldens.txt is writable");
    for entry in fs::read_dir(folder()).expect("tests/goldens").map(|entry| entry.expect("an entry")) {
        if !names.contains(&entry.file_name().to_string_lossy().into_owned()) {
            fs::remove_file(entry.path()).expect("tests/goldens is writable");
        }
    }
}

fn file_name(path: &str, digest: &str) -> String {
    let extension = Path::new(path).extension().and_then(OsStr::to_str).unwrap_or("bin");
    format!("{digest}.{extension}")
}

fn list() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/goldens.txt")
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/goldens")
}
