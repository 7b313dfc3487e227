//! Reports as SARIF (OASIS, "Static Analysis Results Interchange Format", version 2.1.0), which code hosts show beside
//! the lines of a change.

use serde_json::{Value, json};

use super::Report;
use crate::check::findings::{Code, Finding};
use crate::gltf::uri::encode_path;

/// Formats a report as SARIF 2.1.0, for code hosts.
///
/// # Errors
/// Strings and numbers cause none.
pub fn sarif(report: &Report) -> serde_json::Result<String> {
    let rules: Vec<Value> = Code::ALL.iter().map(|code| rule(*code)).collect();
    let results: Vec<Value> = report.findings.iter().map(result).collect();
    let log = json!({
        "$schema": "https://docs.oasis-open.org/sarif/sarif/v2.1.0/os/schemas/sarif-schema-2.1.0.json",
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": { "name": "roughcast", "semanticVersion": report.version, "rules": rules } },
            "artifacts": report.files.iter().map(|file| json!({ "location": location(file) })).collect::<Vec<_>>(),
            "results": results,
        }],
    });
    Ok(serde_json::to_string_pretty(&log)? + "\n")
}

fn rule(code: Code) -> Value {
    json!({
        "id": code.to_string(),
        "shortDescription": { "text": code.title() },
        "help": { "text": format!("Cause and remedy: docs/findings.md of roughcast, {code}.") },
        "defaultConfiguration": { "level": code.severity().name() },
    })
}

fn result(finding: &Finding) -> Value {
    let mut place = json!({ "physicalLocation": { "artifactLocation": location(&finding.file) } });
    if !finding.place.is_empty() {
        place["logicalLocations"] = json!([{ "fullyQualifiedName": finding.place }]);
    }
    json!({
        "ruleId": finding.code.to_string(),
        "ruleIndex": Code::ALL.iter().position(|code| *code == finding.code),
        "level": finding.severity.name(),
        "message": { "text": finding.message },
        "locations": [place],
    })
}

/// Returns the location of a file. Relative paths stay relative; readers resolve them against the folder of the run.
fn location(file: &str) -> Value {
    let path = encode_path(&file.replace('\\', "/"));
    json!({ "uri": if path.starts_with('/') { format!("file://{path}") } else { path } })
}
