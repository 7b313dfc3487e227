//! Reports as text, JSON, SARIF and JUnit.

mod junit;
mod sarif;

pub use junit::junit;
pub use sarif::sarif;

use serde::Serialize;

use super::findings::{Finding, Severity};
use crate::text::{counted, printable};

/// The format version of reports of `check`.
pub const CHECK_FORMAT: u32 = 1;

/// What a run of `check` found.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Report {
    /// The format version, [`CHECK_FORMAT`].
    pub format_version: u32,
    /// The version of the tool.
    pub version: &'static str,
    /// The checked documents and textures, whether given by name or found in folders, in order.
    pub files: Vec<String>,
    /// All findings, grouped by file.
    pub findings: Vec<Finding>,
}

impl Default for Report {
    fn default() -> Self {
        let version = env!("CARGO_PKG_VERSION");
        Self { format_version: CHECK_FORMAT, version, files: Vec::new(), findings: Vec::new() }
    }
}

impl Report {
    /// Returns the number of findings of a severity.
    pub fn count(&self, severity: Severity) -> usize {
        self.findings.iter().filter(|f| f.severity == severity).count()
    }

    /// Returns whether there is an error or a warning.
    pub fn is_failure(&self) -> bool {
        self.findings.iter().any(|f| f.severity != Severity::Note)
    }
}

/// Formats a report for people: a line for each finding under its file, and a summary.
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
    text += &format!(
        "{} checked: {}, {}, {}\n",
        counted(report.files.len(), "file"),
        counted(counts[0], "error"),
        counted(counts[1], "warning"),
        counted(counts[2], "note")
    );
    text
}

/// Formats a report as JSON, described by `schemas/check.schema.json`.
///
/// # Errors
/// Strings and numbers cause none.
pub fn json(report: &Report) -> serde_json::Result<String> {
    Ok(serde_json::to_string_pretty(report)? + "\n")
}
