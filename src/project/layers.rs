//! Layers of settings, the later winning, and where each value came from.

use std::fmt::{self, Display};

use serde_json::{Map, Value};

use crate::project::values::{ValueError, Values};
use crate::settings::Settings;
use crate::text::printable;

/// Settings that come from one place.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// The place, for a person.
    pub origin: String,
    /// What it says.
    pub values: Values,
}

/// What holds for an asset.
#[derive(Clone, Debug, PartialEq)]
pub struct Resolved {
    /// Every value that is set, without `engine`: what it stands for is said in its stead.
    pub values: Map<String, Value>,
    /// The settings.
    pub settings: Settings,
    origins: Map<String, Value>,
}

/// The last word of `layers` on each setting, over the defaults.
///
/// # Errors
/// [`ValueError`] for what is out of range or does not go together.
pub fn resolve(layers: &[Layer]) -> Result<Resolved, ValueError> {
    let (mut values, mut origins) = (Values::defaults().said(), Map::new());
    let profile = layers.iter().rev().find_map(|layer| layer.values.profile).unwrap_or_default();
    for Layer { origin, values: layer } in layers {
        let preset =
            layer.engine.map(|engine| (engine.values(profile), format!("{origin}, engine = {}", name(&engine))));
        let parts = preset.iter().map(|(values, origin)| (values, origin)).chain([(layer, origin)]);
        for (part, origin) in parts {
            for (name, value) in part.said().into_iter().filter(|(name, _)| name != "engine") {
                origins.insert(name.clone(), Value::from(origin.clone()));
                values.insert(name, value);
            }
        }
    }
    // Values that were written by `Values` are read by it.
    let typed: Values = serde_json::from_value(Value::Object(values.clone())).unwrap_or_default();
    Ok(Resolved { settings: typed.settings()?, values, origins })
}

fn name(engine: &crate::project::values::Engine) -> String {
    serde_json::to_value(engine).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default()
}

/// Lines of TOML, each with its origin, as a terminal may show them.
impl Display for Resolved {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lines: Vec<(String, &str)> = Values::names()
            .iter()
            .filter_map(|name| {
                // JSON's strings, numbers, booleans and lists of numbers are TOML's too.
                let value = self.values.get(name)?;
                let origin = self.origins.get(name).and_then(Value::as_str).unwrap_or("default");
                Some((format!("{name} = {value}"), origin))
            })
            .collect();
        let width = lines.iter().map(|(line, _)| line.len()).max().unwrap_or(0);
        lines.iter().try_for_each(|(line, origin)| writeln!(f, "{line:width$}  # {}", printable(origin)))
    }
}
