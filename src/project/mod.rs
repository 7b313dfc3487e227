//! `roughcast.toml`: settings for a folder of assets, with overrides for some of them.
//!
//! Settings come in layers, the later winning: defaults, the file, its overrides in order, the command line. An
//! `engine` stands for what it needs in its own layer, beneath the other values of that layer.

mod file;
mod globs;
pub(crate) mod inputs;
mod layers;
mod remote;
mod values;

pub use inputs::{Input, InputError};

pub use file::{Config, ConfigError, FILE_NAME, TEMPLATE};
pub use globs::GlobError;
pub use layers::{Layer, Resolved, resolve};
pub use remote::RemoteValues;
pub use values::{Engine, FrameName, ValueError, Values};
