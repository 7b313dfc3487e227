//! Comparisons as comma-separated values (RFC 4180).

use std::io;

use super::{Axis, Comparison, Entry};

/// The columns of [`row`] behind the name of the material.
const HEADINGS: [&str; 11] = [
    "material",
    "name",
    "kind",
    "chosen",
    "error",
    "picture_error",
    "gpu_bytes",
    "file_bytes",
    "bake_seconds",
    "fetches",
    "operations",
];

/// Writes one row for each entry of each material, below a heading. Cells without a value are empty.
///
/// # Errors
/// None that strings can cause.
pub fn csv(comparisons: &[Comparison]) -> io::Result<String> {
    let mut table = csv::WriterBuilder::new().terminator(csv::Terminator::CRLF).from_writer(Vec::new());
    let levels = comparisons.iter().flat_map(|c| &c.entries).map(|e| e.level_errors.len()).max().unwrap_or(0);
    let heading = HEADINGS.map(str::to_owned).into_iter().chain((0..levels).map(|level| format!("level_{level}")));
    table.write_record(heading)?;
    for Comparison { material, entries, .. } in comparisons {
        for entry in entries {
            let errors = &entry.level_errors;
            let by_level = (0..levels).map(|level| errors.get(level).map_or(String::new(), |e| format!("{e:.6}")));
            let cells = [material.clone()].into_iter().chain(row(entry)).map(without_formula);
            table.write_record(cells.chain(by_level))?;
        }
    }
    let bytes = table.into_inner().map_err(|error| error.into_error())?;
    String::from_utf8(bytes).map_err(io::Error::other)
}

/// Returns the cells of an entry: name, kind, whether chosen, errors and costs.
pub fn row(entry: &Entry) -> Vec<String> {
    let chosen = if entry.chosen { "chosen" } else { "" };
    let kind = format!("{:?}", entry.kind).to_lowercase();
    let mut cells = vec![entry.name.clone(), kind, chosen.to_owned(), format!("{:.6}", entry.error)];
    cells.push(entry.picture_error.map_or(String::new(), |error| format!("{error:.6}")));
    let cost = |axis: Axis| {
        axis.value(&entry.cost).map_or(String::new(), |n| match axis {
            Axis::BakeSeconds => format!("{n:.3}"),
            _ => format!("{n}"),
        })
    };
    cells.extend(Axis::ALL.map(cost));
    cells
}

/// Returns `cell` with an apostrophe in front of what spreadsheets would run as a formula, which makes it text (OWASP,
/// "CSV Injection").
fn without_formula(cell: String) -> String {
    if cell.starts_with(['=', '+', '-', '@', '\t', '\r']) { format!("'{cell}") } else { cell }
}
