//! What was drawn, as data. `schemas/render.schema.json` describes it as JSON.

use serde::Serialize;

use crate::render::{Crop, Difference, SceneName};

/// The format version of the JSON.
pub const RENDER_FORMAT: u32 = 1;

/// The report of all pictures.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct PicturesReport {
    /// The format version, [`RENDER_FORMAT`].
    pub format_version: u32,
    /// The page that shows all pictures.
    pub gallery: String,
    /// The sheets, in the order of the scenes and of the materials.
    pub sheets: Vec<SheetReport>,
}

/// The report of a sheet.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct SheetReport {
    /// The file.
    pub path: String,
    /// What the sheet shows: asset, material and scene.
    pub title: String,
    /// The name of the material, as in file names; absent for the highlight, which shows none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// The scene.
    pub scene: SceneName,
    /// The rows; empty for the highlight.
    pub rows: Vec<RowReport>,
}

/// The report of one distance.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct RowReport {
    /// Distance from the eye to the surface, in repeats of the map.
    pub distance: f64,
    /// The columns beside the supersampled column.
    pub columns: Vec<ColumnReport>,
    /// The file of the supersampled picture.
    pub supersampled: String,
    /// Expected relative L1 of the supersampled column against a column with infinitely many samples.
    pub noise: f64,
    /// Columns and rows of each picture.
    pub size: [u32; 2],
    /// The region that is shown enlarged, in which the columns differ most from the supersampled column.
    pub crop: Crop,
}

/// The report of a picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ColumnReport {
    /// The column: `plain`, `portable` or `pyramid`.
    pub name: &'static str,
    /// The file.
    pub path: String,
    /// Its difference from the supersampled column.
    #[serde(flatten)]
    pub difference: Difference,
}
