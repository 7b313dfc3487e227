//! Names of pictures and charts.

use std::collections::BTreeSet;

use crate::bake::fit_name;

/// Most bytes of the names of an asset and of a material in the name of a picture or a chart.
const MOST_NAME: usize = 80;

/// Returns a file name: `helmet` and `Glass / Plastic` become `helmet.Glass___Plastic`. Adds a number to a name that is
/// taken.
pub fn file_name(stem: &str, material: &str, taken: &mut BTreeSet<String>) -> String {
    let safe = |c: char| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' };
    let name = fit_name(&material.chars().map(safe).collect::<String>(), MOST_NAME);
    let name = if stem.is_empty() { name } else { format!("{}.{name}", fit_name(stem, MOST_NAME)) };
    let numbered = |n: u32| if n == 1 { name.clone() } else { format!("{name}-{n}") };
    // On case-insensitive file systems, names that differ in case only are one file.
    (1..).map(numbered).find(|name| taken.insert(name.to_lowercase())).unwrap_or_default()
}
