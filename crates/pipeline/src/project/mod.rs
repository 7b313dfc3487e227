//! `roughcast.toml`: settings for a folder of assets, with overrides for some of them.
//!
//! Settings come from sources, of which a later one overrides the earlier ones: the defaults, the file, its overrides
//! in order, the command line. The values of an engine's preset yield to other values of the source that sets `engine`.

mod destination;
mod file;
mod globs;
pub(crate) mod inputs;
mod protect;
mod record;
mod remote;
mod resolve;
mod selection;
mod trust;

pub use inputs::{Input, InputError};

pub use crate::settings::engines::Engine;
pub use crate::settings::values::Values;
pub use destination::named_container;
pub use file::{Config, ConfigError, FILE_NAME, TEMPLATE};
pub use globs::GlobError;
pub use protect::protect;
pub use record::{GLB_MAGIC, is_baked, recorded};
pub use remote::RemoteValues;
pub use resolve::{ConfigSource, Resolved, resolve};
pub use selection::{ConfigChoice, Selected, Selection, SelectionError};
pub use trust::NamedServer;
