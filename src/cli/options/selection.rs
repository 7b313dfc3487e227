//! Options that select assets and configure them.

use std::io::{self, Write};
use std::path::PathBuf;

use super::texture::{DocumentOptions, TextureOptions};
use super::view::ViewOptions;
use crate::cli::terminal::outcome::Outcome;
use crate::lobe::Family;
use crate::project::{ConfigChoice, Selected, Selection, Values};

/// Where outputs go and how they are made.
#[derive(Debug, clap::Args)]
pub struct SelectionOptions {
    /// Output folder; or, for one input, the document: FILE.glb with everything inside, or FILE.gltf with its files
    /// beside it. [default: `output` in roughcast.toml]
    #[arg(short, long, value_name = "DIR|FILE")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    settings: SettingOptions,
}

/// How outputs are made.
#[derive(Debug, clap::Args)]
pub struct SettingOptions {
    /// Settings of every asset, instead of the roughcast.toml in its folder or in the nearest folder above.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Read no roughcast.toml.
    #[arg(long, conflicts_with = "config")]
    no_config: bool,
    /// The lobe that the engine shades with. [default: ggx]
    #[arg(long, value_enum)]
    lobe: Option<Family>,
    #[command(flatten)]
    texture: TextureOptions,
    #[command(flatten)]
    document: DocumentOptions,
    #[command(flatten)]
    view: ViewOptions,
}

impl SelectionOptions {
    /// Returns the selection that the options describe.
    pub fn selection(&self) -> Selection {
        Selection { output: self.output.clone(), ..self.settings.selection() }
    }
}

impl SettingOptions {
    /// Returns the selection that the options describe, without an output folder.
    pub fn selection(&self) -> Selection {
        let config = match &self.config {
            _ if self.no_config => ConfigChoice::Ignored,
            Some(path) => ConfigChoice::Named(path.clone()),
            None => ConfigChoice::Nearest,
        };
        let values = Values { lobe: self.lobe, ..self.view.values(self.document.values(self.texture.values())) };
        Selection { config, values, output: None }
    }
}

/// Prints the inputs that cannot be used and, unless `is_quiet`, the documents that were left out. Returns the outcome
/// so far, and whether outputs may be written.
///
/// # Errors
/// When `err` cannot be written to.
pub fn print_problems(selected: &Selected, is_quiet: bool, err: &mut dyn Write) -> io::Result<(bool, Outcome)> {
    for error in &selected.errors {
        writeln!(err, "error: {error}")?;
    }
    if let Some(note) = selected.note_of_baked().filter(|_| !is_quiet) {
        writeln!(err, "note: {note}")?;
    }
    Ok((selected.is_safe(), if selected.errors.is_empty() { Outcome::Done } else { Outcome::Failed }))
}
