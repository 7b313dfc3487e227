//! Entries of a comparison: a model with its error and its cost.

use serde::Serialize;

use super::cost::Cost;

/// The origin of an entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// This tool.
    Ours,
    /// Another tool, by its formula.
    Peer,
    /// The best possible single lobe.
    Oracle,
}

/// What people read in place of the oracle's name.
pub const BEST_LOBE: &str = "best possible lobe";

/// A model, its error and its cost.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Entry {
    /// Name.
    pub name: String,
    /// Its origin.
    pub kind: Kind,
    /// Whether `--model auto` chooses this model.
    pub chosen: bool,
    /// Mean lobe error of levels 2 to 7, or of all levels if the map has no level 2; 0 to 1.
    pub error: f64,
    /// Mean lobe error of each level from 0 on.
    pub level_errors: Vec<f64>,
    /// Relative L1 of pictures; `None` if none were drawn. None are drawn of the best lobe, since the search for the
    /// lobe of each texel of a picture would take hours.
    pub picture_error: Option<f64>,
    /// Its cost.
    #[serde(flatten)]
    pub cost: Cost,
}

impl Entry {
    /// Returns the name for people; files for programs have [`Self::name`].
    pub fn shown_name(&self) -> &str {
        if self.kind == Kind::Oracle { BEST_LOBE } else { &self.name }
    }
}

/// All entries of a material.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Comparison {
    /// Its name.
    pub material: String,
    /// What `--model auto` chose and what that is worth, in a few sentences; absent if that is not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verdict: Option<String>,
    /// Expected relative L1 of a perfect picture; `None` if no pictures were drawn.
    pub picture_noise: Option<f64>,
    /// Our models, then peers, then the oracle.
    pub entries: Vec<Entry>,
}
