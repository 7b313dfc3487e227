//! The numbers as comma-separated values (RFC 4180).

use super::{Axis, Comparison, Entry};

/// One row for each entry of each material, below a heading. Cells without a value are empty.
pub fn csv(comparisons: &[Comparison]) -> String {
    let mut text = "material,name,kind,chosen,error,gpu_bytes,file_bytes,bake_seconds,fetches,operations".to_owned();
    let levels = comparisons.iter().flat_map(|c| &c.entries).map(|e| e.level_errors.len()).max().unwrap_or(0);
    (0..levels).for_each(|level| text += &format!(",level_{level}"));
    text += "\r\n";
    for Comparison { material, entries } in comparisons {
        for entry in entries {
            let mut cells = vec![quoted(material)];
            cells.extend(row(entry).iter().map(|cell| quoted(cell)));
            let errors = &entry.level_errors;
            cells.extend((0..levels).map(|level| errors.get(level).map_or(String::new(), |e| format!("{e:.6}"))));
            text += &cells.join(",");
            text += "\r\n";
        }
    }
    text
}

/// Name, kind, whether chosen, error and costs.
pub fn row(entry: &Entry) -> Vec<String> {
    let chosen = if entry.chosen { "chosen" } else { "" };
    let kind = format!("{:?}", entry.kind).to_lowercase();
    let mut cells = vec![entry.name.clone(), kind, chosen.to_owned(), format!("{:.6}", entry.error)];
    let cost = |axis: Axis| {
        axis.of(&entry.cost).map_or(String::new(), |n| match axis {
            Axis::BakeSeconds => format!("{n:.3}"),
            _ => format!("{n}"),
        })
    };
    cells.extend(Axis::ALL.map(cost));
    cells
}

/// Returns `text` as a cell. Spreadsheets run what begins as a formula; an apostrophe in front makes it text (OWASP, "CSV
/// Injection").
fn quoted(text: &str) -> String {
    let text = if text.starts_with(['=', '+', '-', '@', '\t', '\r']) { &format!("'{text}") } else { text };
    if text.contains(['"', ',', '\r', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}
