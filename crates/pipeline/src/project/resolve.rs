//! Resolves settings from their sources, of which a later one overrides the earlier ones, and records the origin of
//! each value.

use std::fmt::{self, Display};

use crate::settings::engines::Engine;
use crate::settings::values::{Origins, Values};
use crate::settings::{Settings, SettingsError};
use crate::text::printable;

/// A source of settings: a file, an override in a file, or the command line.
#[derive(Clone, Debug, PartialEq)]
pub struct ConfigSource {
    /// The name of the source, for a person.
    pub origin: String,
    /// The settings that the source sets.
    pub values: Values,
}

/// The settings that hold for an asset.
#[derive(Clone, Debug, PartialEq)]
pub struct Resolved {
    /// Every value that is set. `engine` is not: the values of its preset are.
    pub values: Values,
    /// The settings.
    pub settings: Settings,
    /// The engine whose preset holds.
    pub engine: Option<Engine>,
    origins: Origins,
}

/// Merges `sources` over the defaults: of two sources that set a value, the later one holds.
///
/// # Errors
/// [`SettingsError`] for values that are out of range or do not go together.
pub fn resolve(sources: &[ConfigSource]) -> Result<Resolved, SettingsError> {
    let (mut values, mut origins) = (Values::defaults(), Origins::default());
    // Whether a preset, and no explicit value, has set the container.
    let mut has_container_of_preset = false;
    let profile = sources.iter().rev().find_map(|source| source.values.profile).unwrap_or_default();
    for ConfigSource { origin, values: explicit } in sources {
        if let Some(engine) = explicit.engine {
            let needs = Values::of_engine(engine, profile);
            // A preset without a container does not keep that of an earlier preset.
            values.glb = values.glb.filter(|_| !has_container_of_preset);
            has_container_of_preset |= needs.glb.is_some();
            origins.record(&needs, &format!("{origin}, engine = {}", engine.preset().name));
            values = values.overridden_by(&needs);
        }
        has_container_of_preset &= explicit.glb.is_none();
        origins.record(explicit, origin);
        values = values.overridden_by(explicit);
    }
    let engine = values.engine.take();
    Ok(Resolved { settings: values.settings()?, values, engine, origins })
}

impl Resolved {
    /// Returns whether nothing says how the engine shades anisotropic lobes, and lobes may become anisotropic.
    pub fn leaves_engine_open(&self) -> bool {
        self.engine.is_none() && self.values.leaves_engine_open(self.origins.has_max_model())
    }
}

/// Writes lines of TOML, each with the origin of its value, as a terminal may show them.
impl Display for Resolved {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lines: Vec<(String, &str)> = self
            .values
            .lines(&self.origins)
            .into_iter()
            .map(|(name, value, origin)| (format!("{name} = {value}"), origin.unwrap_or("default")))
            .collect();
        let width = lines.iter().map(|(line, _)| line.len()).max().unwrap_or(0);
        lines.iter().try_for_each(|(line, origin)| writeln!(f, "{line:width$}  # {}", printable(origin)))
    }
}

#[cfg(test)]
mod tests;
