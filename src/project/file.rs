//! The file: its keys, its overrides, and what is wrong with it, by line.

use std::path::{Path, PathBuf};

use globset::GlobSet;
use serde_json::json;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use crate::project::globs::{GlobError, globs};
use crate::project::layers::Layer;
use crate::project::remote::RemoteValues;
use crate::project::values::Values;

/// What the file is called.
pub const FILE_NAME: &str = "roughcast.toml";

/// A file in which every setting stands with its default, as a comment.
pub const TEMPLATE: &str = include_str!("template.toml");

/// A read file.
#[derive(Clone, Debug)]
pub struct Config {
    /// The file, as it was named.
    pub path: PathBuf,
    /// Output folder, relative to the file's own.
    pub output: Option<PathBuf>,
    /// The server that bakes, its files relative to the file's own folder.
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

/// What is wrong with a file. The caller adds its name.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConfigError {
    /// Not TOML.
    #[error("line {line}: expected TOML, found: {reason}")]
    Syntax {
        /// Line, from 1.
        line: usize,
        /// What the parser says.
        reason: String,
    },
    /// A key that is no setting.
    #[error(
        "line {line}: expected the name of a setting, found {key:?}{}; `roughcast init` writes them all",
        suggest(suggestion)
    )]
    UnknownKey {
        /// Line, from 1.
        line: usize,
        /// The key.
        key: String,
        /// The name that is most like it.
        suggestion: Option<String>,
    },
    /// A value of the wrong kind.
    #[error("line {line}: {key}: expected another value, found: {reason}")]
    Value {
        /// Line, from 1.
        line: usize,
        /// The key.
        key: String,
        /// What the reader says.
        reason: String,
    },
    /// A glob that cannot be matched.
    #[error("line {line}: files: {error}")]
    Glob {
        /// Line, from 1.
        line: usize,
        /// What is wrong with it.
        error: GlobError,
    },
}

fn suggest(name: &Option<String>) -> String {
    name.as_ref().map_or_else(String::new, |name| format!("; did you mean {name:?}"))
}

impl Config {
    /// Reads `text`, the content of `path`.
    ///
    /// # Errors
    /// [`ConfigError`] for the first thing that is wrong, whether or not an asset would need it.
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

    /// The file's layers for `asset`, a path relative to the file's folder.
    pub fn layers(&self, asset: &Path) -> Vec<Layer> {
        let place = self.path.display();
        let mut layers = vec![Layer { origin: place.to_string(), values: self.defaults.clone() }];
        for part in self.overrides.iter().filter(|part| part.globs.is_match(asset)) {
            let origin = format!("{place}, override of {}", part.patterns.join(", "));
            layers.push(Layer { origin, values: part.values.clone() });
        }
        layers
    }
}

/// Keys with their values.
type Entries<'t> = Vec<(&'t str, &'t Spanned<DeValue<'t>>)>;

struct Reader<'t> {
    text: &'t str,
}

impl Reader<'_> {
    /// The settings in `table`, and its entries of the names `others`.
    fn values<'t>(&self, table: &'t DeTable<'t>, others: &[&str]) -> Result<(Values, Entries<'t>), ConfigError> {
        let names = Values::names();
        let (mut said, mut rest) = (serde_json::Map::new(), Vec::new());
        for (key, value) in table.iter() {
            let name = key.get_ref().as_ref();
            if others.contains(&name) {
                rest.push((name, value));
                continue;
            }
            if !names.iter().any(|n| n == name) {
                return Err(self.unknown(key, names.iter().map(String::as_str).chain(others.iter().copied())));
            }
            let json = to_json(value.get_ref()).ok_or_else(|| self.wrong(name, value, "no finite value"))?;
            // One by one, so that the line of the wrong one is known.
            serde_json::from_value::<Values>(json!({ name: json }))
                .map_err(|e| self.wrong(name, value, &e.to_string()))
                .and_then(|values| match values.settings() {
                    Err(error @ crate::project::values::ValueError::Range { .. }) => {
                        Err(self.wrong(name, value, &error.to_string()))
                    }
                    _ => Ok(()),
                })?;
            said.insert(name.to_owned(), json);
        }
        let values = serde_json::from_value(said.into()).unwrap_or_default();
        Ok((values, rest))
    }

    /// What `[remote]` says.
    fn remote(&self, table: &DeTable<'_>) -> Result<RemoteValues, ConfigError> {
        let names = RemoteValues::names();
        let mut said = serde_json::Map::new();
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
            serde_json::from_value::<RemoteValues>(json!({ name: json }))
                .map_err(|e| self.wrong(name, value, &e.to_string()))?;
            said.insert(name.to_owned(), json);
        }
        Ok(serde_json::from_value(said.into()).unwrap_or_default())
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
        ConfigError::UnknownKey { line, key: name.to_owned(), suggestion: most_like(name, known) }
    }

    fn wrong(&self, key: &str, value: &Spanned<DeValue<'_>>, reason: &str) -> ConfigError {
        ConfigError::Value { line: self.line(value.span().start), key: key.to_owned(), reason: reason.to_owned() }
    }

    fn line(&self, offset: usize) -> usize {
        1 + self.text.bytes().take(offset).filter(|byte| *byte == b'\n').count()
    }
}

/// The table's members as JSON.
fn members(table: &DeTable<'_>) -> Option<serde_json::Value> {
    let pairs = table.iter().map(|(key, value)| Some((key.get_ref().to_string(), to_json(value.get_ref())?)));
    pairs.collect::<Option<serde_json::Map<_, _>>>().map(Into::into)
}

/// As JSON; `None` for tables, and where JSON has no such value.
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

/// The name most like `key`, if any is.
fn most_like<'n>(key: &str, names: impl Iterator<Item = &'n str>) -> Option<String> {
    let key = key.replace('_', "-").to_lowercase();
    let scored = names.map(|name| (strsim::jaro_winkler(&key, name), name));
    let (score, name) = scored.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (score > 0.75).then(|| name.to_owned())
}

#[cfg(test)]
mod tests;
