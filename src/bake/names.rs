//! Names of output files: stable, readable, and unlike each other on every file system.

use std::collections::{BTreeSet, HashMap};

/// Most bytes of what a name tells of its source. File systems take 255 for a name; the rest is for what stands around it,
/// such as `.anisotropy-1000.ktx2`.
const MOST_STEM: usize = 200;

/// Digits of the digest that a cut name ends with.
const DIGITS: usize = 16;

/// Returns `name`, or if it has more than `most` bytes, its beginning and a digest of all of it: names that differ only at
/// the end stay different.
pub fn fit_name(name: &str, most: usize) -> String {
    if name.len() <= most {
        return name.to_owned();
    }
    let start = &name[..name.floor_char_boundary(most.saturating_sub(DIGITS + 1))];
    format!("{start}-{}", &blake3::hash(name.as_bytes()).to_hex()[..DIGITS])
}

/// Returns what the outputs of the asset whose file is called `stem` without extension are called: mostly the same.
pub fn output_stem(stem: &str) -> String {
    fit_name(stem, MOST_STEM)
}

/// Returns what names beside the document begin with for the asset whose file is called `stem` without its extension. A `:` or
/// `\` becomes `_`, since no URI may name it ([`crate::gltf::uri`]).
pub fn portable_stem(stem: &str) -> String {
    stem.replace([':', '\\'], "_")
}

/// Gives out paths in the folder `<portable stem>.roughcast`, relative to the document.
pub struct Names {
    folder: String,
    taken: BTreeSet<String>,
    /// The last number of each name, so that many of one name do not try all numbers again.
    last: HashMap<String, u32>,
}

impl Names {
    /// For the asset whose outputs are called `stem`.
    pub fn new(stem: &str) -> Self {
        Self { folder: format!("{}.roughcast", portable_stem(stem)), taken: BTreeSet::new(), last: HashMap::new() }
    }

    /// `<folder>/<stem>.<content>`, numbered from the second of its kind on; without an extension.
    pub fn unique(&mut self, stem: &str, content: &str) -> String {
        let stem: String = stem.chars().map(|c| if is_portable(c) { c } else { '_' }).collect();
        let stem = fit_name(&stem, MOST_STEM);
        let name = |number: u32| match number {
            1 => format!("{stem}.{content}"),
            _ => format!("{stem}.{content}-{number}"),
        };
        // Case-insensitive file systems see one file where names differ by case only.
        let last = self.last.entry(name(1).to_lowercase()).or_insert(0);
        let number = (*last + 1..).find(|n| self.taken.insert(name(*n).to_lowercase())).unwrap_or(1);
        *last = number;
        format!("{}/{}", self.folder, name(number))
    }
}

/// Whether every file system takes the character in a name.
fn is_portable(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '-' | '_' | '.' | ' ')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_portable() {
        let mut names = Names::new("helmet");
        assert_eq!(names.unique("Brass", "normal"), "helmet.roughcast/Brass.normal");
        assert_eq!(names.unique("brass", "normal"), "helmet.roughcast/brass.normal-2");
        assert_eq!(names.unique("Brass", "roughness"), "helmet.roughcast/Brass.roughness");
        assert_eq!(names.unique("a/b:c*", "normal"), "helmet.roughcast/a_b_c_.normal");
        assert_eq!(names.unique("BRASS", "normal"), "helmet.roughcast/BRASS.normal-3");
        assert_eq!(Names::new("a:b\\c").unique("Brass", "normal"), "a_b_c.roughcast/Brass.normal");
    }

    /// Each would try all numbers before its own: 5 * 10^9 of them.
    #[test]
    fn many_textures_of_one_name_are_numbered_one_after_the_other() {
        let mut names = Names::new("helmet");
        let last = (0..100_000).map(|_| names.unique("image", "normal")).last();
        assert_eq!(last.as_deref(), Some("helmet.roughcast/image.normal-100000"));
    }

    #[test]
    fn long_names_are_cut_between_characters_and_stay_different() {
        assert_eq!(fit_name("brass", 5), "brass");
        for (letter, most) in [("a", 40), ("ü", 40), ("ü", 41), ("\u{1f4a7}", 43)] {
            let long = letter.repeat(100);
            let (first, second) = (fit_name(&format!("{long}1"), most), fit_name(&format!("{long}2"), most));
            assert!(first.len() <= most && first.len() + 4 > most && second.len() <= most, "{first}");
            assert!(first.starts_with(letter) && first != second, "{first}");
            assert_eq!(first, fit_name(&format!("{long}1"), most));
        }
    }
}
