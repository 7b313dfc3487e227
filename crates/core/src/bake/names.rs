//! Names of output files: stable, readable, and distinct on every file system.

use std::collections::{BTreeSet, HashMap};
use std::path::Path;

/// Maximum bytes of the stem of a name. File systems allow 255 bytes for a name; the rest is for an ending such as
/// `.anisotropy-1000.ktx2`.
const MAX_STEM: usize = 200;

/// Digits of the digest at the end of a name that was cut.
const DIGITS: usize = 16;

/// Returns `name` if it has at most `max` bytes, else its beginning and a digest of the whole name. Names that differ
/// only at the end stay different.
pub fn fit_name(name: &str, max: usize) -> String {
    if name.len() <= max {
        return name.to_owned();
    }
    let start = &name[..name.floor_char_boundary(max.saturating_sub(DIGITS + 1))];
    format!("{start}-{}", &blake3::hash(name.as_bytes()).to_hex()[..DIGITS])
}

/// Returns the stem of the outputs of an asset whose file has the stem `stem`: the same, unless it is too long.
pub fn output_stem(stem: &str) -> String {
    fit_name(stem, MAX_STEM)
}

/// Returns what the outputs of the file at `path` are called: [`output_stem`] of its name without the extension.
pub fn output_stem_of(path: &Path) -> String {
    output_stem(&path.file_stem().unwrap_or_default().to_string_lossy())
}

/// Returns the stem of the files and folders beside the document. A `:` or `\` becomes `_`, since no URI may contain it
/// ([`crate::gltf::uri`]).
pub fn portable_stem(stem: &str) -> String {
    stem.replace([':', '\\'], "_")
}

/// Makes paths in the folder `<portable stem>.roughcast`, relative to the document.
pub struct Names {
    folder: String,
    taken: BTreeSet<String>,
    /// The last number of each name, so that many files of one name do not try all numbers again.
    last: HashMap<String, u32>,
}

impl Names {
    /// Starts with no names, for the asset whose outputs have the stem `stem`.
    pub fn new(stem: &str) -> Self {
        Self { folder: format!("{}.roughcast", portable_stem(stem)), taken: BTreeSet::new(), last: HashMap::new() }
    }

    /// Returns `<folder>/<stem>.<content>`, without an extension. From the second such name on, a number is added.
    pub fn unique(&mut self, stem: &str, content: &str) -> String {
        let stem: String = stem.chars().map(|c| if is_portable(c) { c } else { '_' }).collect();
        let stem = fit_name(&stem, MAX_STEM);
        let name = |number: u32| match number {
            1 => format!("{stem}.{content}"),
            _ => format!("{stem}.{content}-{number}"),
        };
        // Names that differ by case only are one file on some file systems.
        let last = self.last.entry(name(1).to_lowercase()).or_insert(0);
        let number = (*last + 1..).find(|n| self.taken.insert(name(*n).to_lowercase())).unwrap_or(1);
        *last = number;
        format!("{}/{}", self.folder, name(number))
    }
}

/// Returns whether every file system allows the character in a name.
fn is_portable(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '-' | '_' | '.' | ' ')
}

#[cfg(test)]
mod tests;
