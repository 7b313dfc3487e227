//! Reads `roughcast.toml`: its keys, its overrides, and the line of what is wrong with it.

use std::path::{Path, PathBuf};

use globset::GlobSet;
use serde_json::json;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use crate::project::globs::{GlobError, globs};
use crate::project::remote::RemoteValues;
use crate::project::resolve::ConfigSource;
use crate::settings::SettingsError;
use crate::settings::values::Values;

/// The name of the file.
pub const FILE_NAME: &str = "roughcast.toml";

/// A file that has every setting with its default, as a comment.
pub const TEMPLATE: &str = include_str!("template.toml");

/// A configuration file that was read.
#[derive(Clone, Debug)]
pub struct Config {
    /// The path of the file, as the user named it.
    pub path: PathBuf,
    /// The output folder, relative to the folder of the file.
    pub output: Option<PathBuf>,
    /// The server that bakes. Its files are relative to the folder of the configuration.
    pub remote: Option<RemoteValues>,
    defaults: Values,
    overrides: Vec<Override>,
}

#[derive(Clone, Debug)]
struct Override {
    patterns: Vec<String>,
    globs: GlobSet,
    values: Values,
}

/// What is wrong with a configuration file. The caller adds the name of the file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConfigError {
    /// The file is not TOML.
    #[error("line {line}: expected TOML, found: {reason}; fix the line")]
    Syntax {
        /// Line, from 1.
        line: usize,
        /// What the parser says.
        reason: String,
    },
    /// A key is not the name of a setting.
    #[error(
        "line {line}: expected the name of a setting, found {key:?}{}; `roughcast init` writes them all",
        suggest(suggestion)
    )]
    UnknownKey {
        /// Line, from 1.
        line: usize,
        /// The key.
        key: String,
        /// The name of a setting that is most similar to the key.
        suggestion: Option<String>,
    },
    /// A value has the wrong type or is out of range.
    #[error(
        "line {line}: {key}: expected another value, found: {reason}; `roughcast init` writes examples of all values"
    )]
    Value {
        /// Line, from 1.
        line: usize,
        /// The key.
        key: String,
        /// What the reader says.
        reason: String,
    },
    /// A glob cannot be compiled.
    #[error("line {line}: files: {error}")]
    Glob {
        /// Line, from 1.
        line: usize,
        /// What is wrong with the glob.
        error: GlobError,
    },
}

fn suggest(name: &Option<String>) -> String {
    name.as_ref().map_or_else(String::new, |name| format!("; did you mean {name:?}"))
}

impl Config {
    /// Parses `text`, the content of `path`.
    ///
    /// # Errors
    /// [`ConfigError`] for the first thing that is wrong, even in an override that matches no asset.
    pub fn parse(text: &str, path: &Path) -> Result<Self, ConfigError> {
        let reader = Reader { text };
        let table = DeTable::parse(text).map_err(|error| ConfigError::Syntax {
            line: reader.line(error.span().map_or(0, |span| span.start)),
            reason: error.message().replace('\n', ", "),
        })?;
        let (defaults, rest) = reader.values(table.get_ref(), &["output", "override", "remote"])?;
        let (path, overrides) = (path.to_owned(), Vec::new());
        let mut config = Self { path, output: None, remote: None, defaults, overrides };
        for (key, value) in rest {
            match (key, value.get_ref()) {
                ("output", DeValue::String(folder)) => config.output = Some(PathBuf::from(folder.as_ref())),
                ("override", DeValue::Array(tables)) => {
                    for table in tables.iter() {
                        config.overrides.push(reader.overriding(table)?);
                    }
                }
                ("remote", DeValue::Table(table)) => config.remote = Some(reader.remote(table)?),
                ("remote", _) => return Err(reader.wrong(key, value, "not a table; write [remote]")),
                ("output", _) => return Err(reader.wrong(key, value, "not a string")),
                _ => return Err(reader.wrong(key, value, "not a list of tables; write [[override]]")),
            }
        }
        Ok(config)
    }

    /// Returns the sources of settings for `asset`: the file, then its overrides that match. `asset` is relative to the
    /// folder of the file.
    pub fn sources(&self, asset: &Path) -> Vec<ConfigSource> {
        let path = self.path.display();
        let mut sources = vec![ConfigSource { origin: path.to_string(), values: self.defaults.clone() }];
        for part in self.overrides.iter().filter(|part| part.globs.is_match(asset)) {
            let origin = format!("{path}, override of {}", part.patterns.join(", "));
            sources.push(ConfigSource { origin, values: part.values.clone() });
        }
        sources
    }
}

/// Keys with their values.
type Entries<'t> = Vec<(&'t str, &'t Spanned<DeValue<'t>>)>;

struct Reader<'t> {
    text: &'t str,
}

impl Reader<'_> {
    /// Returns the settings in `table`, and its entries of the names `others`.
    fn values<'t>(&self, table: &'t DeTable<'t>, others: &[&str]) -> Result<(Values, Entries<'t>), ConfigError> {
        let names = Values::names();
        let (mut values, mut rest) = (Values::default(), Vec::new());
        for (key, value) in table.iter() {
            let name = key.get_ref().as_ref();
            if others.contains(&name) {
                rest.push((name, value));
                continue;
            }
            if !names.iter().any(|n| n == name) {
                return Err(self.unknown(key, names.iter().map(String::as_str).chain(others.iter().copied())));
            }
            // Keys are read one by one, so that the line of a wrong one is known.
            let json = to_json(value.get_ref()).ok_or_else(|| self.wrong(name, value, "no finite value"))?;
            let single: Values =
                serde_json::from_value(json!({ name: json })).map_err(|e| self.wrong(name, value, &e.to_string()))?;
            if let Err(SettingsError::Range { expected, found, .. }) = single.settings() {
                return Err(self.wrong(name, value, &format!("{found} instead of {expected}")));
            }
            values = values.overridden_by(&single);
        }
        Ok((values, rest))
    }

    /// Returns the server in `[remote]`.
    fn remote(&self, table: &DeTable<'_>) -> Result<RemoteValues, ConfigError> {
        let names = RemoteValues::names();
        let mut values = RemoteValues::default();
        for (key, value) in table.iter() {
            let name = key.get_ref().as_ref();
            if !names.iter().any(|n| n == name) {
                return Err(self.unknown(key, names.iter().map(String::as_str)));
            }
            let json = match value.get_ref() {
                DeValue::Table(table) => members(table),
                single => to_json(single),
            };
            let json = json.ok_or_else(|| self.wrong(name, value, "no finite value"))?;
            let single: RemoteValues =
                serde_json::from_value(json!({ name: json })).map_err(|e| self.wrong(name, value, &e.to_string()))?;
            values = values.overridden_by(single);
        }
        Ok(values)
    }

    fn overriding<'t>(&self, table: &'t Spanned<DeValue<'t>>) -> Result<Override, ConfigError> {
        let DeValue::Table(entries) = table.get_ref() else {
            return Err(self.wrong("override", table, "not a table; write [[override]]"));
        };
        let (values, rest) = self.values(entries, &["files"])?;
        let Some((_, files)) = rest.first() else {
            return Err(self.wrong("override", table, "no files; name those that it is for, as files = \"props/**\""));
        };
        let list: Vec<&DeValue<'_>> = match files.get_ref() {
            DeValue::Array(list) => list.iter().map(Spanned::get_ref).collect(),
            single => vec![single],
        };
        let mut patterns = Vec::new();
        for pattern in list {
            let DeValue::String(pattern) = pattern else {
                return Err(self.wrong("files", files, "neither a glob nor a list of globs"));
            };
            patterns.push(pattern.to_string());
        }
        let line = self.line(files.span().start);
        let globs = globs(&patterns).map_err(|error| ConfigError::Glob { line, error })?;
        Ok(Override { patterns, globs, values })
    }

    fn unknown<'n>(&self, key: &Spanned<DeString<'_>>, known: impl Iterator<Item = &'n str>) -> ConfigError {
        let name = key.get_ref().as_ref();
        let line = self.line(key.span().start);
        ConfigError::UnknownKey { line, key: name.to_owned(), suggestion: most_similar(name, known) }
    }

    fn wrong(&self, key: &str, value: &Spanned<DeValue<'_>>, reason: &str) -> ConfigError {
        ConfigError::Value { line: self.line(value.span().start), key: key.to_owned(), reason: reason.to_owned() }
    }

    fn line(&self, offset: usize) -> usize {
        1 + self.text.bytes().take(offset).filter(|byte| *byte == b'\n').count()
    }
}

/// Returns the members of a table as JSON; `None` if one of them has no value in JSON.
fn members(table: &DeTable<'_>) -> Option<serde_json::Value> {
    let pairs = table.iter().map(|(key, value)| Some((key.get_ref().to_string(), to_json(value.get_ref())?)));
    pairs.collect::<Option<serde_json::Map<_, _>>>().map(Into::into)
}

/// Returns a value as JSON; `None` for tables, dates, and numbers that JSON does not have.
fn to_json(value: &DeValue<'_>) -> Option<serde_json::Value> {
    Some(match value {
        DeValue::String(text) => text.as_ref().into(),
        DeValue::Boolean(truth) => (*truth).into(),
        DeValue::Integer(number) => i64::from_str_radix(number.as_str(), number.radix()).ok()?.into(),
        DeValue::Float(number) => serde_json::Number::from_f64(number.as_str().parse().ok()?)?.into(),
        DeValue::Array(list) => list.iter().map(|v| to_json(v.get_ref())).collect::<Option<Vec<_>>>()?.into(),
        DeValue::Table(_) | DeValue::Datetime(_) => return None,
    })
}

/// Returns the name that is most similar to `key`; `None` if none is similar.
fn most_similar<'n>(key: &str, names: impl Iterator<Item = &'n str>) -> Option<String> {
    let key = key.replace('_', "-").to_lowercase();
    let scored = names.map(|name| (strsim::jaro_winkler(&key, name), name));
    let (score, name) = scored.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (score > 0.75).then(|| name.to_owned())
}

#[cfg(test)]
mod tests;
