//! The selection of assets, and the settings that hold for each of them.

mod configs;
mod error;

pub use error::SelectionError;

use std::path::{Path, PathBuf};

use self::configs::{Configs, FoundConfig};
use super::destination::{Destination, named_container};
use super::inputs::{self, Input, InputError};
use super::record::is_baked;
use super::resolve::{ConfigSource, Resolved, resolve};
use super::trust::NamedServer;
use crate::gltf::document::Container;
use crate::note::Note;
use crate::output::folder_of;
use crate::settings::Settings;
use crate::settings::values::Values;

/// Which `roughcast.toml` holds for an asset.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum ConfigChoice {
    /// The one in the folder of the asset, or in the nearest folder above.
    #[default]
    Nearest,
    /// This file, for every asset.
    Named(PathBuf),
    /// None.
    Ignored,
}

/// How assets are selected and configured.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// Which configuration holds.
    pub config: ConfigChoice,
    /// Explicit values, which win over those of configurations.
    pub values: Values,
    /// The output folder, or the document that the one input is baked to. `None` takes the folder that the
    /// configuration of the first input names.
    pub output: Option<PathBuf>,
}

/// The assets of a command.
pub struct Selected {
    /// The assets, each with its settings.
    pub assets: Vec<(Input, Resolved)>,
    /// The output folder.
    pub output: PathBuf,
    /// Inputs that cannot be used.
    pub errors: Vec<InputError>,
    /// Documents that were left out because an earlier bake wrote them.
    pub baked: Vec<PathBuf>,
    /// The settings of assets without a configuration.
    pub settings: Settings,
    /// The configurations that were read.
    pub configs: Vec<PathBuf>,
    /// The server that the configuration of the first input names.
    pub remote: Option<NamedServer>,
}

impl Selected {
    /// Returns whether outputs may be written. Among sources no output is safe, not even the outputs of other inputs.
    pub fn is_safe(&self) -> bool {
        !self.errors.iter().any(|error| matches!(error, InputError::OutputIsInput { .. }))
    }

    /// Returns the different notes on bakes for the engines of presets.
    pub fn notes_on_engines(&self) -> Vec<Note> {
        let mut notes = Vec::new();
        for (_, resolved) in &self.assets {
            for note in resolved.engine.map(|engine| engine.notes(&resolved.settings)).unwrap_or_default() {
                if !notes.contains(&note) {
                    notes.push(note);
                }
            }
        }
        notes
    }

    /// Returns whether nothing says how the engine of an asset shades anisotropic lobes.
    pub fn leaves_engine_open(&self) -> bool {
        self.assets.iter().any(|(_, resolved)| resolved.leaves_engine_open())
    }

    /// Returns a note on documents that were left out; `None` where there are none.
    pub fn note_of_baked(&self) -> Option<String> {
        let (example, count) = (self.baked.first()?.display(), self.baked.len());
        Some(format!(
            "left out {count} file(s) that Roughcast has baked, such as {example}; name a file itself to bake it anyway"
        ))
    }
}

impl Selection {
    /// Finds the assets of `arguments` and their settings.
    ///
    /// # Errors
    /// [`SelectionError`] where no asset can be selected.
    pub fn find(&self, arguments: &[PathBuf]) -> Result<Selected, SelectionError> {
        self.find_by(arguments, &mut is_baked)
    }

    /// Finds the assets of `arguments` and their settings. Documents in folders for which `is_baked` returns true are
    /// outputs of earlier bakes and are left out.
    ///
    /// # Errors
    /// [`SelectionError`] where no asset can be selected.
    pub fn find_by(
        &self,
        arguments: &[PathBuf],
        is_baked: &mut dyn FnMut(&Path) -> bool,
    ) -> Result<Selected, SelectionError> {
        let mut configs = Configs::default();
        let named = self.output.as_deref().map(|output| Destination::new(output, arguments)).transpose()?;
        let first = arguments.first().ok_or(SelectionError::NoOutput)?;
        let folder = if first.is_dir() { first.as_path() } else { first.parent().unwrap_or(Path::new("")) };
        let found = self.config(&mut configs, folder)?;
        let destination = match named {
            Some(named) => named,
            None => {
                let folder = found.map(FoundConfig::output_folder).transpose()?.flatten();
                Destination::folder(&folder.ok_or(SelectionError::NoOutput)?)
            }
        };
        let remote = found.and_then(FoundConfig::remote);
        let selected = Selected { remote, ..self.select(configs, arguments, destination, is_baked)? };
        for (_, resolved) in &selected.assets {
            resolved.settings.target.check_available()?;
        }
        Ok(selected)
    }

    /// Finds the assets of `arguments` that are baked to `output`, and their settings.
    ///
    /// # Errors
    /// [`SelectionError`] where no asset can be selected.
    pub fn find_into(&self, arguments: &[PathBuf], output: &Path) -> Result<Selected, SelectionError> {
        self.select(Configs::default(), arguments, Destination::folder(output), &mut is_baked)
    }

    /// Finds the asset that `arguments` name, if any, and its settings. It is baked to the file `output`.
    ///
    /// # Errors
    /// [`SelectionError`] where no asset can be selected.
    pub fn find_named(&self, arguments: &[PathBuf], output: &Path) -> Result<Selected, SelectionError> {
        let document = named_container(output).and_then(|_| Destination::new(output, arguments).ok());
        // A texture, or a name that a bake does not write.
        let folder = || Destination::folder(folder_of(output));
        let destination = document.unwrap_or_else(folder);
        self.select(Configs::default(), arguments, destination, &mut is_baked)
    }

    /// Returns whether a configuration or a value is explicit.
    pub fn is_explicit(&self) -> bool {
        self.config != ConfigChoice::Nearest || self.values != Values::default()
    }

    fn select(
        &self,
        mut configs: Configs,
        arguments: &[PathBuf],
        destination: Destination,
        is_baked: &mut dyn FnMut(&Path) -> bool,
    ) -> Result<Selected, SelectionError> {
        let flags = ConfigSource { origin: "command line".to_owned(), values: self.values(&destination)? };
        let inputs::Found { inputs, errors, baked } = inputs::find(arguments, &destination, is_baked);
        let mut assets = Vec::with_capacity(inputs.len());
        for input in inputs {
            let folder = input.path.parent().unwrap_or(Path::new(""));
            let mut sources = match self.config(&mut configs, folder)? {
                Some(found) => found.config.sources(&found.relative(&input.path)),
                None => Vec::new(),
            };
            sources.push(flags.clone());
            let resolved = resolve(&sources)?;
            assets.push((input, resolved));
        }
        let settings = resolve(&[flags]).map_or_else(|_| Settings::default(), |resolved| resolved.settings);
        let configs = configs.into_paths();
        Ok(Selected { assets, output: destination.folder, errors, baked, settings, configs, remote: None })
    }

    /// Returns the explicit values. The extension of a named document decides on its container.
    fn values(&self, destination: &Destination) -> Result<Values, SelectionError> {
        let Some(document) = &destination.document else { return Ok(self.values.clone()) };
        let is_glb = document.container == Container::Glb;
        match self.values.glb.filter(|explicit| *explicit != is_glb) {
            Some(is_glb) => Err(SelectionError::OtherContainer { path: document.path.clone(), is_glb }),
            None => Ok(Values { glb: Some(is_glb), ..self.values.clone() }),
        }
    }

    fn config<'c>(&self, configs: &'c mut Configs, folder: &Path) -> Result<Option<&'c FoundConfig>, SelectionError> {
        match &self.config {
            ConfigChoice::Ignored => Ok(None),
            ConfigChoice::Named(path) => configs.named(path),
            ConfigChoice::Nearest => configs.above(folder),
        }
    }
}
