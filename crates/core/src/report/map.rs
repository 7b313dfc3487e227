//! The report of a standalone map. `schemas/map.schema.json` describes it as JSON.

use serde::Serialize;

use super::{Choice, TextureReport};
use crate::note::Note;
use crate::settings::Model;

/// The format version of the JSON.
pub const MAP_FORMAT: u32 = 1;

/// What a standalone map became.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct MapReport {
    /// The format version, [`MAP_FORMAT`].
    pub format_version: u32,
    /// What is modelled of the lost bumps.
    pub model: Model,
    /// How the model was chosen; absent if the base roughness is not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub choice: Option<Choice>,
    /// What is not as exact as it could be, and why.
    pub notes: Vec<Note>,
    /// The files. The first one is the bump map: normals or offsets.
    pub textures: Vec<TextureReport>,
}

impl MapReport {
    /// Returns the report of `textures`.
    pub fn new(model: Model, choice: Option<Choice>, notes: Vec<Note>, textures: Vec<TextureReport>) -> Self {
        Self { format_version: MAP_FORMAT, model, choice, notes, textures }
    }
}
