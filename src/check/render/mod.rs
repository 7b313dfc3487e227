//! A report in the forms that people and programs read.

mod junit;
mod sarif;

pub use junit::junit;
pub use sarif::sarif;

use serde::Serialize;

use super::findings::{Finding, Severity};
use crate::text::printable;

/// What a run of `check` found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Version of the tool.
    pub version: &'static str,
    /// The documents and textures that were named or found in folders, in order.
    pub files: Vec<String>,
    /// Grouped by file.
    pub findings: Vec<Finding>,
}

impl Report {
    /// Number of findings of a severity.
    pub fn count(&self, severity: Severity) -> usize {
        self.findings.iter().filter(|f| f.severity == severity).count()
    }

    /// Whether something is wrong: an error or a warning.
    pub fn is_failure(&self) -> bool {
        self.findings.iter().any(|f| f.severity != Severity::Note)
    }
}

/// For a person: a line per finding under its file, and a summary.
pub fn text(report: &Report) -> String {
    let mut text = String::new();
    for group in report.findings.chunk_by(|a, b| a.file == b.file) {
        if let Some(first) = group.first() {
            text += &format!("{}\n", printable(&first.file));
        }
        for finding in group {
            let place = if finding.place.is_empty() { String::new() } else { format!("{}: ", finding.place) };
            let (severity, code, title) = (finding.severity.name(), finding.code, finding.code.title());
            let line = format!("  {severity} {code} {place}{title}: {}", finding.message);
            text += &format!("{}\n", printable(&line));
        }
    }
    let counts = [Severity::Error, Severity::Warning, Severity::Note].map(|s| report.count(s));
    let plural = |n: usize, word: &str| format!("{n} {word}{}", if n == 1 { "" } else { "s" });
    text += &format!(
        "{} checked: {}, {}, {}\n",
        plural(report.files.len(), "file"),
        plural(counts[0], "error"),
        plural(counts[1], "warning"),
        plural(counts[2], "note")
    );
    text
}

/// For machines: `schemas/check.schema.json`.
///
/// # Errors
/// None that strings and numbers can cause.
pub fn json(report: &Report) -> serde_json::Result<String> {
    Ok(serde_json::to_string_pretty(report)? + "\n")
}
