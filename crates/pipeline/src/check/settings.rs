//! Comparison of recorded settings with the settings of a bake today.

use serde_json::{Map, Value, json};

use super::findings::{Code, Findings};
use crate::settings::{RecordedSettings, Settings};

/// Compares the `recorded` settings of a texture with `expected`, by their names in `roughcast.toml`.
pub fn check_settings(recorded: &Value, expected: &Settings, place: &str, findings: &mut Findings) {
    // `map` does not read roughcast.toml and has further settings.
    if recorded.get("map").is_some() {
        return;
    }
    let expected = json!(RecordedSettings::new(expected, expected.model));
    // Other versions may have recorded other settings, so both sides are compared by name.
    let (recorded, expected) = (named(recorded), named(&expected));
    let names = expected.keys().chain(recorded.keys().filter(|name| !expected.contains_key(*name)));
    let text = |settings: &Map<String, Value>, name: &str| match settings.get(name) {
        None | Some(Value::Null) => format!("{name} unset"),
        // Numbers are recorded in single precision, as they are used.
        Some(Value::Number(number)) if number.is_f64() => {
            format!("{name} = {:?}", number.as_f64().unwrap_or_default() as f32)
        }
        Some(value) => format!("{name} = {value}"),
    };
    let pairs = names.map(|name| (text(&expected, name), text(&recorded, name)));
    let (expected, found): (Vec<_>, Vec<_>) = pairs.filter(|(expected, found)| expected != found).unzip();
    if !found.is_empty() {
        let (expected, found) = (expected.join(", "), found.join(", "));
        let message = format!("expected {expected}, found {found}; bake again, or check with the flags of the bake");
        findings.add(Code::OtherSettings, place, message);
    }
}

/// Returns the settings of a provenance by their names in `roughcast.toml`:
/// `{"maxError": ..., "view": {"screenHeight": ...}}` becomes `max-error` and `screen-height`.
fn named(settings: &Value) -> Map<String, Value> {
    let mut named = Map::new();
    for (key, value) in settings.as_object().into_iter().flatten() {
        match (key.as_str(), value) {
            ("view", Value::Object(view)) => {
                named.extend(view.iter().map(|(key, value)| (kebab(key), value.clone())));
            }
            // The requested model replaces the model that `auto` chose.
            ("asked", asked) => {
                named.insert("model".to_owned(), asked.clone());
            }
            _ => {
                named.insert(kebab(key), value.clone());
            }
        }
    }
    named
}

fn kebab(name: &str) -> String {
    name.chars().flat_map(|c| c.is_uppercase().then_some('-').into_iter().chain(c.to_lowercase())).collect()
}
