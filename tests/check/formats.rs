//! Tests that SARIF and JUnit reports satisfy their published schemas.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use roughcast::check::{Code, Finding, Report, junit, sarif};
use roughcast::cli::Outcome;
use serde_json::Value;

use crate::fixture::{bake, roughcast};
use crate::schemas::assert_valid;
use crate::skip::missing_tool;

/// Returns a report with each code once, and with texts that must be escaped.
fn report() -> Report {
    let finding = |(index, code): (usize, &Code)| Finding {
        code: *code,
        severity: code.severity(),
        file: format!("/baked/<a> & \"b\" {}.gltf", index % 3),
        place: if index % 4 == 0 { String::new() } else { format!("/materials/{index}\u{1}") },
        message: "expected ]]> & <normals>, found \u{0}\u{7}\r\nänderung 🙂; bake again".to_owned(),
    };
    let mut findings: Vec<Finding> = Code::ALL.iter().enumerate().map(finding).collect();
    findings.sort_by(|a, b| a.file.cmp(&b.file));
    let files = ["/baked/<a> & \"b\" 0.gltf", "clean one.ktx2"].map(str::to_owned).to_vec();
    Report { version: "1.2.3", files, findings, ..Report::default() }
}

/// Returns the path of a file in the sources of one of the crates of `tools/report-schemas`.
fn published_file(package: &str, path: &str) -> Option<PathBuf> {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/report-schemas/Cargo.toml");
    let arguments = ["metadata", "--offline", "--locked", "--format-version", "1", "--manifest-path"];
    let output = Command::new(env!("CARGO")).args(arguments).arg(manifest).output().unwrap();
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap_or_default();
    let found = metadata["packages"].as_array().and_then(|packages| packages.iter().find(|p| p["name"] == package));
    let file = found.and_then(|p| Some(Path::new(p["manifest_path"].as_str()?).with_file_name(path)));
    if file.is_none() {
        missing_tool("schemas of reports need `cargo fetch --manifest-path tools/report-schemas/Cargo.toml`");
    }
    file
}

fn assert_is_sarif(text: &str) {
    let Some(schema) = published_file("serde-sarif", "src/schema.json") else { return };
    let mut schema: Value = serde_json::from_slice(&fs::read(schema).unwrap()).unwrap();
    // The published pattern of languages has an extra bracket, which only regular expressions of JavaScript accept.
    for object in ["run", "toolComponent"] {
        schema["definitions"][object]["properties"]["language"].as_object_mut().unwrap().remove("pattern");
    }
    let validator = jsonschema::validator_for(&schema).unwrap();
    assert!(!validator.is_valid(&serde_json::json!({ "version": "2.1.0" })), "the schema requires runs");
    assert_valid(&validator, &serde_json::from_str(text).unwrap());
}

fn assert_is_junit(text: &str) {
    let Some(schema) = published_file("junit-report", "tests/JUnit.xsd") else { return };
    let tool = Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/validate-junit");
    if !tool.join("node_modules/xmllint-wasm").is_dir() {
        return missing_tool("validating JUnit reports needs Node 20 and `npm ci` in tools/validate-junit");
    }
    let folder = tempfile::tempdir().unwrap();
    let is_valid = |text: &str| {
        let file = folder.path().join("report.xml");
        fs::write(&file, text).unwrap();
        let output = Command::new("node").arg(tool.join("validate.mjs")).arg(&schema).arg(file).output().unwrap();
        (output.status.success(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    assert!(!is_valid("<testsuites><case/></testsuites>").0, "the schema has no such element");
    let (valid, errors) = is_valid(text);
    assert!(valid, "{errors}\n{text}");
}

#[test]
fn sarif_of_every_finding_is_valid() {
    let text = sarif(&report()).unwrap();
    assert_is_sarif(&text);
    let log: Value = serde_json::from_str(&text).unwrap();
    let run = &log["runs"][0];
    assert_eq!(run["results"].as_array().unwrap().len(), Code::ALL.len());
    for result in run["results"].as_array().unwrap() {
        let rule = &run["tool"]["driver"]["rules"][result["ruleIndex"].as_u64().unwrap() as usize];
        assert_eq!(rule["id"], result["ruleId"]);
    }
    let first = &run["results"][0]["locations"][0]["physicalLocation"]["artifactLocation"]["uri"];
    assert_eq!(first, "file:///baked/%3Ca%3E%20%26%20%22b%22%200.gltf");
}

#[test]
fn junit_of_every_finding_is_valid() {
    let text = junit(&report()).unwrap();
    assert_is_junit(&text);
    let notes = Code::ALL.iter().filter(|c| c.severity().name() == "note").count();
    assert_eq!(text.matches("<failure ").count(), Code::ALL.len() - notes);
    // The clean file passes.
    assert!(text.contains("<testcase name=\"check\" classname=\"clean one.ktx2\"/>"), "{text}");
}

#[test]
fn the_command_prints_sarif_and_junit() {
    let bake = bake(&["--no-provenance"]);
    let check = |format: &str| roughcast(&["check", bake.baked.to_str().unwrap(), "--format", format]);
    let (outcome, text, err) = check("sarif");
    assert_eq!((outcome, err.as_str()), (Outcome::Done, ""));
    assert_is_sarif(&text);
    assert!(text.contains("RC1501"), "{text}");
    let (outcome, text, err) = check("junit");
    assert_eq!((outcome, err.as_str()), (Outcome::Done, ""));
    assert_is_junit(&text);
    assert!(text.contains("RC1501") && !text.contains("<failure"), "{text}");
}
