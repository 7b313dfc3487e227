//! Comparisons as JSON, which `schemas/compare.schema.json` describes.

use serde::Serialize;

use super::Comparison;

/// The format version of compare.json.
pub const COMPARE_FORMAT: u32 = 1;

/// The comparisons of all materials.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct ComparisonReport {
    /// The format version, [`COMPARE_FORMAT`].
    pub format_version: u32,
    /// The version of the tool.
    pub version: &'static str,
    /// The materials, in the order of the document.
    pub materials: Vec<Comparison>,
}

impl ComparisonReport {
    /// Returns the report of this version of the tool.
    pub fn new(materials: Vec<Comparison>) -> Self {
        Self { format_version: COMPARE_FORMAT, version: env!("CARGO_PKG_VERSION"), materials }
    }

    /// Returns the report as JSON, without a line break at the end.
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("numbers and strings serialise")
    }
}
