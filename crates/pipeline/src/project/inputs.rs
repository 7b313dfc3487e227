//! Finds the assets that a command line names, and where their outputs go.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fs;
use std::path::{Path, PathBuf};

use walkdir::WalkDir;

use super::destination::Destination;
use crate::bake::output_stem;
use crate::output::{case_folded, folder_of};

/// An asset to bake.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    /// The .gltf or .glb file.
    pub path: PathBuf,
    /// The output folder.
    pub folder: PathBuf,
    /// The name of the outputs without extension: that of the source, shortened if it is too long, or the name that the
    /// user chose.
    pub stem: String,
}

/// An input that cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum InputError {
    /// Neither a glTF file nor a folder.
    #[error("{}: expected a .gltf or .glb file or a folder, found {found}; check the path", path.display())]
    NotAnAsset {
        /// The path.
        path: PathBuf,
        /// What it is instead.
        found: String,
    },
    /// A folder without assets.
    #[error(
        "{}: expected .gltf or .glb files in the folder, found {}",
        path.display(),
        scene.as_ref().map_or_else(
            || "none; check the path".to_owned(),
            |scene| format!("others such as {}; export the scenes as glTF 2.0", scene.display())
        )
    )]
    EmptyFolder {
        /// The folder.
        path: PathBuf,
        /// A scene in it in another format.
        scene: Option<PathBuf>,
    },
    /// A folder whose assets are all outputs of earlier bakes.
    #[error(
        "{}: expected assets in the folder, found only what Roughcast has baked ({count}, such as {}); name the folder of \
         the sources, or a file itself to bake it anyway",
        path.display(), example.display()
    )]
    OnlyBaked {
        /// The folder.
        path: PathBuf,
        /// The number of baked documents.
        count: usize,
        /// The first baked document.
        example: PathBuf,
    },
    /// A folder or an entry of it that cannot be read.
    #[error("{}: expected a folder that can be read, found: {reason}; check its permissions", path.display())]
    Walk {
        /// The folder or entry.
        path: PathBuf,
        /// The message of the system.
        reason: String,
    },
    /// A name that no URI can hold.
    #[error("{}: expected a file name in UTF-8, found one that is not; rename the file", path.display())]
    NotUtf8 {
        /// The file.
        path: PathBuf,
    },
    /// Two inputs have the same output.
    #[error(
        "{}: expected inputs with outputs of their own, found that {} is baked to the same place; bake them into \
         different folders",
        path.display(), other.display()
    )]
    SameOutput {
        /// The later input.
        path: PathBuf,
        /// The earlier input.
        other: PathBuf,
    },
    /// Two inputs have outputs whose names differ in case only.
    #[error(
        "{}: expected a path that differs from {} in more than case, since the outputs are one file on Windows and macOS; \
         rename one of them, or bake them into different folders",
        path.display(), other.display()
    )]
    SameName {
        /// The later input.
        path: PathBuf,
        /// The earlier input.
        other: PathBuf,
    },
    /// The output folder is an input folder, or contains one.
    #[error(
        "{}: expected an output folder apart from the inputs, found one that is or holds an input folder; choose another \
         with -o",
        path.display()
    )]
    OutputIsInput {
        /// The folder.
        path: PathBuf,
    },
}

impl InputError {
    /// Returns the path that cannot be used.
    pub fn path(&self) -> &Path {
        match self {
            Self::NotAnAsset { path, .. }
            | Self::EmptyFolder { path, .. }
            | Self::OnlyBaked { path, .. }
            | Self::Walk { path, .. }
            | Self::NotUtf8 { path }
            | Self::SameOutput { path, .. }
            | Self::SameName { path, .. }
            | Self::OutputIsInput { path } => path,
        }
    }
}

/// The result of [`find`].
#[derive(Debug, Default)]
pub struct Found {
    /// Assets, in a fixed order.
    pub inputs: Vec<Input>,
    /// Inputs that cannot be used. The other inputs can.
    pub errors: Vec<InputError>,
    /// Documents in folders that are left out because an earlier bake wrote them.
    pub baked: Vec<PathBuf>,
}

/// Finds the assets that `arguments` name. Outputs of files go to the folder of `destination` itself, and folders keep
/// their structure below it. Documents in folders for which `is_baked` returns true are left out.
pub fn find(arguments: &[PathBuf], destination: &Destination, is_baked: &mut dyn FnMut(&Path) -> bool) -> Found {
    let mut all = Found::default();
    // The key is the name of the output on systems that ignore case; the value is the exact name and the input.
    let mut taken: BTreeMap<PathBuf, (PathBuf, PathBuf)> = BTreeMap::new();
    for argument in arguments {
        let found = find_one(argument, destination, is_baked)
            .unwrap_or_else(|error| Found { errors: vec![error], ..Found::default() });
        all.errors.extend(found.errors);
        all.baked.extend(found.baked);
        for input in found.inputs {
            let name = input.folder.join(&input.stem);
            match taken.entry(case_folded(&name)) {
                Entry::Occupied(taken) if taken.get().1 != input.path => {
                    let (path, (other_name, other)) = (input.path, taken.get().clone());
                    all.errors.push(match other_name == name {
                        true => InputError::SameOutput { path, other },
                        false => InputError::SameName { path, other },
                    });
                }
                Entry::Occupied(_) => {}
                Entry::Vacant(free) => {
                    free.insert((name, input.path.clone()));
                    all.inputs.push(input);
                }
            }
        }
    }
    all
}

/// Extensions of scene formats from which other tools export glTF.
const SCENES: [&str; 16] =
    ["3ds", "abc", "blend", "c4d", "dae", "fbx", "ma", "max", "mb", "obj", "ply", "stl", "usd", "usda", "usdc", "usdz"];

fn find_one(
    argument: &Path,
    destination: &Destination,
    is_baked: &mut dyn FnMut(&Path) -> bool,
) -> Result<Found, InputError> {
    let (path, output) = (argument.to_owned(), destination.folder.as_path());
    let facts =
        fs::metadata(argument).map_err(|e| InputError::NotAnAsset { path: path.clone(), found: e.to_string() })?;
    let own_folder = if facts.is_dir() { argument } else { folder_of(argument) };
    // An output below a folder of sources could overwrite a source. A document that the user names is no accident.
    let real_output = real(output);
    if destination.document.is_none()
        && real_output.as_ref().is_some_and(|output| real(own_folder).is_some_and(|own| own.starts_with(output)))
    {
        return Err(InputError::OutputIsInput { path: output.to_owned() });
    }
    if facts.is_file() {
        if !is_asset(argument) {
            let found = argument.extension().map_or_else(
                || "a file without extension".to_owned(),
                |e| {
                    let remedy = if is_other_scene(argument) {
                        "export the scene as glTF 2.0"
                    } else {
                        "standalone maps are for `roughcast map`"
                    };
                    format!("a .{} file ({remedy})", e.to_string_lossy())
                },
            );
            return Err(InputError::NotAnAsset { path, found });
        }
        let named = destination.document.as_ref().map(|document| document.stem.clone());
        let found = input(argument, output.to_owned())?;
        let found = Input { stem: named.unwrap_or(found.stem), ..found };
        return Ok(Found { inputs: vec![found], ..Found::default() });
    }
    let Found { mut inputs, mut errors, mut baked } = Found::default();
    let mut scene = None;
    let walk = WalkDir::new(argument).follow_links(true).sort_by_file_name().into_iter();
    let is_output = |folder: &Path| real_output.is_some() && real(folder) == real_output;
    for entry in walk.filter_entry(|e| !(e.file_type().is_dir() && is_output(e.path()))) {
        match entry {
            Err(error) => {
                let path = error.path().unwrap_or(argument).to_owned();
                errors.push(InputError::Walk { path, reason: error.to_string() });
            }
            Ok(entry) if !entry.file_type().is_file() => {}
            Ok(entry) if !is_asset(entry.path()) => {
                scene = scene.or_else(|| is_other_scene(entry.path()).then(|| entry.into_path()));
            }
            Ok(entry) if is_baked(entry.path()) => baked.push(entry.into_path()),
            Ok(entry) => {
                let below = entry.path().strip_prefix(argument).unwrap_or(entry.path());
                match input(entry.path(), output.join(folder_of(below))) {
                    Ok(input) => inputs.push(input),
                    Err(error) => errors.push(error),
                }
            }
        }
    }
    match baked.first() {
        _ if !(inputs.is_empty() && errors.is_empty()) => Ok(Found { inputs, errors, baked }),
        Some(example) => Err(InputError::OnlyBaked { path, count: baked.len(), example: example.clone() }),
        None => Err(InputError::EmptyFolder { path, scene }),
    }
}

fn input(path: &Path, folder: PathBuf) -> Result<Input, InputError> {
    let stem = path.file_stem().and_then(|s| s.to_str());
    let stem = stem.ok_or_else(|| InputError::NotUtf8 { path: path.to_owned() })?;
    Ok(Input { path: path.to_owned(), folder, stem: output_stem(stem) })
}

fn is_other_scene(path: &Path) -> bool {
    path.extension().is_some_and(|e| SCENES.iter().any(|scene| e.eq_ignore_ascii_case(scene)))
}

fn is_asset(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gltf") || e.eq_ignore_ascii_case("glb"))
}

/// Returns the folder without links and dots, even if the folder does not exist.
fn real(folder: &Path) -> Option<PathBuf> {
    crate::output::real(folder).ok()
}
