//! Which assets a command is about, and which settings hold for each.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::options::{DocumentOptions, LobeName, TextureOptions};
use super::outcome::Outcome;
use super::trusted::{self, NamedServer};
use super::view::ViewOptions;
use crate::bake::read_file;
use crate::codec::EncodeError;
use crate::output;
use crate::project::{
    Config, ConfigError, FILE_NAME, Input, InputError, Layer, Resolved, ValueError, Values, inputs, resolve,
};
use crate::run::recorded;
use crate::settings::Settings;

/// Where outputs go and how they are made.
#[derive(Debug, clap::Args)]
pub struct Selection {
    /// Output folder. [default: `output` in roughcast.toml]
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    settings: SettingOptions,
}

/// How outputs are made.
#[derive(Debug, clap::Args)]
pub struct SettingOptions {
    /// Settings of every asset, instead of the roughcast.toml in its folder or in the nearest above.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Read no roughcast.toml.
    #[arg(long, conflicts_with = "config")]
    no_config: bool,
    /// What the engine shades with. [default: ggx]
    #[arg(long, value_enum)]
    lobe: Option<LobeName>,
    #[command(flatten)]
    texture: TextureOptions,
    #[command(flatten)]
    document: DocumentOptions,
    #[command(flatten)]
    view: ViewOptions,
}

/// Why nothing can be done.
#[derive(Debug, thiserror::Error)]
pub enum SelectionError {
    /// A configuration that cannot be read.
    #[error("{}: expected a readable file, found: {error}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's error.
        error: io::Error,
    },
    /// A configuration that is wrong.
    #[error("{}: {error}", path.display())]
    Config {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        error: ConfigError,
    },
    /// Settings that make no sense together.
    #[error(transparent)]
    Value(#[from] ValueError),
    /// A target that this build does not have.
    #[error(transparent)]
    Encode(#[from] EncodeError),
    /// A configuration that came with assets sends outputs to a folder that is not for it to name.
    #[error(
        "{}: expected `output` below the working folder and in no hidden folder, found {}; if outputs belong there, name \
         the folder with -o",
        config.display(), path.display()
    )]
    OutputElsewhere {
        /// The configuration.
        config: PathBuf,
        /// The folder.
        path: PathBuf,
    },
    /// No output folder.
    #[error("expected an output folder, found none; name it with -o, or as `output` in {FILE_NAME}")]
    NoOutput,
}

/// What a command line selects.
pub struct Selected {
    /// Assets, each with its settings.
    pub assets: Vec<(Input, Resolved)>,
    /// Where their outputs go.
    pub output: PathBuf,
    /// Inputs that cannot be used.
    pub errors: Vec<InputError>,
    /// Documents that were left out, since an earlier bake wrote them.
    pub baked: Vec<PathBuf>,
    /// Settings of assets without a configuration.
    pub settings: Settings,
    /// Configurations that were read.
    pub configs: Vec<PathBuf>,
    /// The server that the configuration of the first input names.
    pub remote: Option<NamedServer>,
}

impl Selected {
    /// Complains of inputs that cannot be used, and tells which were left out unless `is_quiet`; returns whether the others
    /// may be worked on, and how the command ends.
    ///
    /// # Errors
    /// When `err` cannot be written to.
    pub fn complain(&self, is_quiet: bool, err: &mut dyn Write) -> io::Result<(bool, Outcome)> {
        for error in &self.errors {
            writeln!(err, "error: {error}")?;
        }
        if let Some(note) = self.note_of_baked().filter(|_| !is_quiet) {
            writeln!(err, "note: {note}")?;
        }
        // Among sources no output is safe, not even that of the other inputs.
        let is_safe = !self.errors.iter().any(|e| matches!(e, InputError::OutputIsInput { .. }));
        Ok((is_safe, if self.errors.is_empty() { Outcome::Done } else { Outcome::Failed }))
    }

    /// Returns what a person should know of documents that were left out, if there are any.
    pub fn note_of_baked(&self) -> Option<String> {
        let (example, count) = (self.baked.first()?.display(), self.baked.len());
        Some(format!(
            "left out {count} file(s) that Roughcast has baked, such as {example}; name a file itself to bake it anyway"
        ))
    }
}

impl Selection {
    /// The assets of `arguments` and their settings.
    ///
    /// # Errors
    /// [`SelectionError`] when nothing can be done.
    pub fn find(&self, arguments: &[PathBuf]) -> Result<Selected, SelectionError> {
        self.find_by(arguments, &mut is_baked)
    }

    /// Finds the assets of `arguments` and their settings, where documents in folders for which `is_baked` holds are outputs of
    /// earlier bakes.
    ///
    /// # Errors
    /// [`SelectionError`] when nothing can be done.
    pub fn find_by(
        &self,
        arguments: &[PathBuf],
        is_baked: &mut dyn FnMut(&Path) -> bool,
    ) -> Result<Selected, SelectionError> {
        let mut configs = Configs::default();
        let first = arguments.first().ok_or(SelectionError::NoOutput)?;
        let folder = if first.is_dir() { first.as_path() } else { first.parent().unwrap_or(Path::new("")) };
        let found = self.settings.config(&mut configs, folder)?;
        let output = match &self.output {
            Some(output) => Some(output.clone()),
            None => found.and_then(|found| found.output_folder().transpose()).transpose()?,
        };
        let remote = found.and_then(Found::remote);
        let output = output.ok_or(SelectionError::NoOutput)?;
        let selected = Selected { remote, ..self.settings.select(configs, arguments, &output, is_baked)? };
        for (_, resolved) in &selected.assets {
            resolved.settings.target.check_available()?;
        }
        Ok(selected)
    }
}

impl SettingOptions {
    /// What flags say.
    fn said(&self) -> Values {
        let lobe = self.lobe.map(Into::into);
        Values { lobe, ..self.view.values(self.document.values(self.texture.values())) }
    }

    /// Whether anything is said.
    pub fn is_explicit(&self) -> bool {
        self.config.is_some() || self.no_config || !self.said().said().is_empty()
    }

    /// The assets of `arguments` that go to `output`, and their settings.
    ///
    /// # Errors
    /// [`SelectionError`] when nothing can be done.
    pub fn find(&self, arguments: &[PathBuf], output: &Path) -> Result<Selected, SelectionError> {
        self.select(Configs::default(), arguments, output, &mut is_baked)
    }

    fn select(
        &self,
        mut configs: Configs,
        arguments: &[PathBuf],
        output: &Path,
        is_baked: &mut dyn FnMut(&Path) -> bool,
    ) -> Result<Selected, SelectionError> {
        let flags = Layer { origin: "command line".to_owned(), values: self.said() };
        let inputs::Found { inputs, errors, baked } = inputs::find(arguments, output, is_baked);
        let mut assets = Vec::with_capacity(inputs.len());
        for input in inputs {
            let folder = input.path.parent().unwrap_or(Path::new(""));
            let mut layers = match self.config(&mut configs, folder)? {
                Some(found) => found.config.layers(&found.relative(&input.path)),
                None => Vec::new(),
            };
            layers.push(flags.clone());
            let resolved = resolve(&layers)?;
            assets.push((input, resolved));
        }
        let settings = resolve(&[flags]).map_or_else(|_| Settings::default(), |resolved| resolved.settings);
        let configs = configs.0.into_values().flatten().map(|found| found.config.path).collect();
        Ok(Selected { assets, output: output.to_owned(), errors, baked, settings, configs, remote: None })
    }

    fn config<'c>(&self, configs: &'c mut Configs, folder: &Path) -> Result<Option<&'c Found>, SelectionError> {
        match &self.config {
            _ if self.no_config => Ok(None),
            Some(named) => configs.named(named),
            None => configs.above(folder),
        }
    }
}

/// Returns whether an earlier bake wrote the document at `path`: it says so itself.
pub fn is_baked(path: &Path) -> bool {
    recorded(path).is_some()
}

/// A configuration and the folder, without links, that its globs are relative to.
struct Found {
    config: Config,
    root: PathBuf,
    /// Whether the user chose it, and not whoever made the assets: see [`super::trusted`].
    is_trusted: bool,
}

impl Found {
    /// `asset` relative to the configuration's folder; as it is when it is elsewhere.
    fn relative(&self, asset: &Path) -> PathBuf {
        let folder = real(asset.parent().unwrap_or(Path::new("")));
        let path = folder.join(asset.file_name().unwrap_or_default());
        path.strip_prefix(&self.root).map_or_else(|_| asset.to_owned(), Path::to_owned)
    }

    /// The output folder that the configuration names.
    fn output_folder(&self) -> Result<Option<PathBuf>, SelectionError> {
        let Some(output) = &self.config.output else { return Ok(None) };
        let path = self.folder().join(output);
        if self.is_trusted || trusted::is_harmless(&path) {
            return Ok(Some(path));
        }
        Err(SelectionError::OutputElsewhere { config: self.config.path.clone(), path })
    }

    /// The server that the configuration names.
    fn remote(&self) -> Option<NamedServer> {
        let values = self.config.remote.clone()?.in_folder(self.folder());
        Some(NamedServer { values, config: self.config.path.clone(), is_trusted: self.is_trusted })
    }

    /// Its folder, as it was named.
    fn folder(&self) -> &Path {
        self.config.path.parent().unwrap_or(Path::new(""))
    }
}

/// Configurations by their folders.
#[derive(Default)]
struct Configs(BTreeMap<PathBuf, Option<Found>>);

impl Configs {
    fn named(&mut self, path: &Path) -> Result<Option<&Found>, SelectionError> {
        let root = real(path.parent().unwrap_or(Path::new("")));
        if !self.0.contains_key(&root) {
            self.0.insert(root.clone(), Some(read(path, &root, true)?));
        }
        Ok(self.0.get(&root).and_then(Option::as_ref))
    }

    /// The configuration in `folder`, or in the nearest folder above that has one.
    fn above(&mut self, folder: &Path) -> Result<Option<&Found>, SelectionError> {
        let start = real(folder);
        if !self.0.contains_key(&start) {
            let roots = start.ancestors().find(|root| root.join(FILE_NAME).is_file());
            let read =
                |root: &Path| read(&named_from_here(&root.join(FILE_NAME)), root, trusted::is_working_folder(root));
            let found = roots.map(read).transpose()?;
            self.0.insert(start.clone(), found);
        }
        Ok(self.0.get(&start).and_then(Option::as_ref))
    }
}

fn read(path: &Path, root: &Path, is_trusted: bool) -> Result<Found, SelectionError> {
    let failed = |error| SelectionError::Read { path: path.to_owned(), error };
    let bytes = read_file(path).map_err(failed)?;
    let text = String::from_utf8(bytes).map_err(|e| failed(io::Error::new(io::ErrorKind::InvalidData, e)))?;
    let config = Config::parse(&text, path).map_err(|error| SelectionError::Config { path: path.to_owned(), error })?;
    Ok(Found { config, root: root.to_owned(), is_trusted })
}

/// Relative to the working folder where it is below it: what a person wrote, and what is the same on every machine.
fn named_from_here(path: &Path) -> PathBuf {
    path.strip_prefix(real(Path::new(""))).map_or_else(|_| path.to_owned(), Path::to_owned)
}

/// The folder without links and dots; as it is where it cannot be resolved.
fn real(folder: &Path) -> PathBuf {
    output::real(folder).unwrap_or_else(|_| folder.to_owned())
}
