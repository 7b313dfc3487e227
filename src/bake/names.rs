//! Names of output files: stable, readable, and unlike each other on every file system.

use std::collections::BTreeSet;

/// Gives out paths in the folder `<stem>.roughcast`, relative to the document.
pub struct Names {
    folder: String,
    taken: BTreeSet<String>,
}

impl Names {
    /// For the asset whose file is called `stem` without its extension.
    pub fn new(stem: &str) -> Self {
        Self { folder: format!("{stem}.roughcast"), taken: BTreeSet::new() }
    }

    /// `<folder>/<stem>.<content>`, numbered from the second of its kind on; without an extension.
    pub fn unique(&mut self, stem: &str, content: &str) -> String {
        let stem: String = stem.chars().map(|c| if is_portable(c) { c } else { '_' }).collect();
        let name = |number: u32| match number {
            1 => format!("{stem}.{content}"),
            _ => format!("{stem}.{content}-{number}"),
        };
        // Case-insensitive file systems see one file where names differ by case only.
        let number = (1..).find(|n| self.taken.insert(name(*n).to_lowercase())).unwrap_or(1);
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
    }
}
