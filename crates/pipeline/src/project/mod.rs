//! `roughcast.toml`: settings for a folder of assets, with overrides for some of them.
//!
//! Settings come in layers, of which a later one overrides the earlier ones: the defaults, the file, its overrides in
//! order, the command line. `engine` sets the values of its preset beneath the other values of its own layer.

mod engines;
mod file;
mod globs;
pub(crate) mod inputs;
mod layers;
mod protect;
mod record;
mod remote;
mod selection;
mod trust;
mod values;

pub use inputs::{Input, InputError};

pub use engines::Engine;
pub use file::{Config, ConfigError, FILE_NAME, TEMPLATE};
pub use globs::GlobError;
pub use layers::{Layer, Resolved, resolve};
pub use protect::protect;
pub use record::{GLB_MAGIC, is_baked, recorded};
pub use remote::RemoteValues;
pub use selection::{ConfigChoice, Selected, Selection, SelectionError};
pub use trust::{NamedServer, is_harmless};
pub use values::{FrameName, Values};
