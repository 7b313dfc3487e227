//! Tests how `roughcast.toml` is found, read, overridden and printed.

use std::fs;

use clap::ValueEnum;
use roughcast::codec::Target;
use roughcast::gltf::layers::LAYERS;
use roughcast::lobe::Family;
use roughcast::project::{Engine, TEMPLATE};
use serde_json::Value;
use tempfile::{TempDir, tempdir};

use super::process::{copy, done, files, fixtures, hashes, run};

/// Writes `assets/brushed`, `assets/props/waves`, and `assets/roughcast.toml` with `config`.
fn scene(config: &str) -> TempDir {
    let folder = tempdir().expect("a folder");
    let assets = folder.path().join("assets");
    copy(&fixtures().join("brushed"), &assets.join("brushed"));
    copy(&fixtures().join("waves"), &assets.join("props"));
    fs::write(assets.join("roughcast.toml"), config).expect("a file");
    folder
}

#[test]
fn settings_of_the_file_equal_those_of_flags() {
    let scene = scene("model = 'isotropic'\ntarget = 'float'\n[[override]]\nfiles = 'props/**'\ngltf = 'strict'\n");
    let folder = scene.path();
    done(folder, "bake assets -o by-file -q");
    done(folder, "bake assets/brushed -o by-flags/brushed -q --no-config --model isotropic --target float");
    let props = "--model isotropic --target float --gltf strict";
    done(folder, &format!("bake assets/props -o by-flags/props -q --no-config {props}"));
    let by_file = hashes(&folder.join("by-file"));
    assert_eq!(by_file, hashes(&folder.join("by-flags")));
    // An asset that is baked alone gets the settings that it has among the others.
    done(folder, "bake assets/props/waves.glb -o alone/props -q");
    for (name, hash) in hashes(&folder.join("alone")) {
        assert_eq!(by_file.get(&name), Some(&hash), "{name}");
    }
}

#[test]
fn flags_win_and_every_value_names_its_origin() {
    let config =
        "max-error = 0.5\nmodel = 'none'\n[[override]]\nfiles = 'waves.glb'\nengine = 'bevy'\nmodel = 'isotropic'\n";
    let scene = scene(config);
    let text = done(scene.path(), "bake assets -o out --print-config --model anisotropic --glb=false");
    let (brushed, waves) = text.split_once("\n\n").expect("two assets");
    let line = |text: &str, name: &str| {
        let line = text.lines().find(|line| line.starts_with(&format!("{name} = "))).expect(name);
        line.split_once('#').map(|(value, origin)| format!("{}|{}", value.trim(), origin.trim())).expect(name)
    };
    assert!(brushed.starts_with("# assets/brushed/brushed.gltf\n"), "{brushed}");
    assert!(waves.starts_with("# assets/props/waves.glb\n"), "{waves}");
    for (asset, name, expected) in [
        (brushed, "max-error", "max-error = 0.5|assets/roughcast.toml"),
        (brushed, "model", "model = \"anisotropic\"|command line"),
        (brushed, "gltf", "gltf = \"strict\"|default"),
        (brushed, "glb", "glb = false|command line"),
        (waves, "model", "model = \"anisotropic\"|command line"),
        (waves, "gltf", "gltf = \"dual\"|assets/roughcast.toml, override of waves.glb, engine = bevy"),
        (waves, "max-error", "max-error = 0.5|assets/roughcast.toml"),
    ] {
        assert_eq!(line(asset, name), expected);
    }
    assert!(!scene.path().join("out").exists(), "--print-config bakes");
}

#[test]
fn the_file_may_name_the_output() {
    let scene = scene("output = '../baked'\nmodel = 'none'\n");
    done(scene.path(), "bake assets -q");
    assert!(scene.path().join("baked/props/waves.glb").is_file());
    done(scene.path(), "bake assets -q -o other");
    assert_eq!(hashes(&scene.path().join("baked")), hashes(&scene.path().join("other")));
    fs::remove_file(scene.path().join("assets/roughcast.toml")).expect("a file");
    let run = run(scene.path(), "bake assets -q");
    assert_eq!((run.code, run.err.contains("name it with -o")), (2, true), "{}", run.err);
}

#[test]
fn reads_a_named_file_or_no_file() {
    let scene = scene("modle = 'none'\n");
    let folder = scene.path();
    fs::write(folder.join("other.toml"), "profile = 'pyramid'\n").expect("a file");
    assert!(done(folder, "bake assets -o out --print-config --config other.toml").contains("# other.toml"));
    assert!(!done(folder, "bake assets -o out --print-config --no-config").contains("toml"));
    for (line, parts) in [
        ("bake assets -o out", ["assets/roughcast.toml: line 1", "did you mean \"model\""]),
        ("bake assets -o out --config missing.toml", ["missing.toml", "expected a readable file"]),
        ("bake assets -o out --config other.toml --no-config", ["--no-config", "cannot be used with"]),
        ("bake assets -o out --config other.toml --trim", ["trim", "nearest"]),
    ] {
        let run = run(folder, line);
        assert_eq!(run.code, 2, "{line}: {}", run.err);
        assert!(parts.iter().all(|part| run.err.contains(part)), "{line}: {}", run.err);
    }
    assert!(!folder.join("out").exists());
}

#[test]
fn reports_list_settings_that_differ() {
    let scene = scene("[[override]]\nfiles = 'waves.glb'\nmodel = 'none'\n");
    let report: Value = serde_json::from_str(&done(scene.path(), "bake assets -o out --json")).expect("JSON");
    assert_eq!(report["settings"]["model"], "auto");
    let model = |index: usize| report["assets"][index].get("settings").map(|s| s["model"].clone());
    assert_eq!((model(0), model(1)), (None, Some("none".into())));
}

#[test]
fn init_writes_a_file_that_changes_nothing_and_never_overwrites() {
    let scene = scene("");
    let folder = scene.path();
    done(folder, "bake assets -o before -q --no-config");
    let run_again = run(folder, "init assets");
    assert_eq!(run_again.code, 1, "an existing file is overwritten");
    assert!(run_again.err.contains("roughcast.toml: expected to write a new file"), "{}", run_again.err);
    fs::remove_file(folder.join("assets/roughcast.toml")).expect("a file");
    assert_eq!(done(folder, "init assets"), "wrote assets/roughcast.toml\n");
    done(folder, "bake assets -o after -q");
    assert_eq!(hashes(&folder.join("before")), hashes(&folder.join("after")));
    assert!(files(&folder.join("after")).len() > 5);
}

/// Returns the schemas of configurations and of reports.
fn schemas() -> [Value; 2] {
    let configuration = include_str!("../../schemas/roughcast.schema.json");
    let report = include_str!("../../schemas/report.schema.json");
    [configuration, report].map(|text| serde_json::from_str(text).expect("JSON"))
}

#[test]
fn schemas_template_and_readme_name_every_engine_target_family_and_layer() {
    let engines: Vec<String> = Engine::names().map(str::to_owned).collect();
    let name = |target: &Target| target.to_possible_value().expect("a name").get_name().to_owned();
    let targets: Vec<String> = Target::value_variants().iter().map(name).collect();
    let family = |family: &Family| family.to_possible_value().expect("a name").get_name().to_owned();
    let families: Vec<String> = Family::value_variants().iter().map(family).collect();
    let layers: Vec<String> = LAYERS.iter().map(|row| row.name.to_owned()).collect();
    let [configuration, report] = schemas();
    for (schema, pointer, names) in [
        (&configuration, "/$defs/settings/properties/engine/enum", &engines),
        (&configuration, "/$defs/settings/properties/target/enum", &targets),
        (&report, "/$defs/settings/properties/target/enum", &targets),
        (&configuration, "/$defs/settings/properties/lobe/enum", &families),
        (&report, "/$defs/settings/properties/lobe/enum", &families),
        (&report, "/$defs/layer/properties/layer/enum", &layers),
    ] {
        assert_eq!(schema.pointer(pointer), Some(&serde_json::json!(names)), "{pointer}");
    }
    for name in engines.iter().chain(&targets).chain(&families) {
        assert!(TEMPLATE.contains(&format!("\"{name}\"")), "{name} is missing in template.toml");
    }
    let readme = include_str!("../../README.md");
    let listed: Vec<&str> =
        readme.split("--engine ").skip(1).filter_map(|rest| rest.split_whitespace().next()).collect();
    assert_eq!(listed, engines, "README.md lists other engines");
}

#[test]
fn the_schema_has_every_setting_and_its_default() {
    let [schema, _] = schemas();
    let validator = jsonschema::validator_for(&schema).expect("a schema");
    let settings = schema["$defs"]["settings"]["properties"].as_object().expect("properties");
    let defaults = serde_json::to_value(roughcast::project::Values::defaults()).expect("JSON");
    let names = roughcast::project::Values::names();
    assert!(settings.keys().eq(names.iter()), "{:?}", settings.keys());
    for (name, property) in settings {
        // Whole numbers are valid as numbers, too.
        let text = |value: Option<&Value>| {
            value.map_or_else(String::new, |v| v.to_string().replace(".0,", ",").replace(".0]", "]"))
        };
        assert_eq!(text(property.get("default")), text(defaults.get(name)).trim_end_matches(".0"), "{name}");
    }
    let valid = serde_json::json!({ "output": "x", "glb": true, "override": [{ "files": ["a"], "quality": "best" }] });
    assert!(validator.is_valid(&valid));
    for (pointer, value) in [("/modle", 1.into()), ("/override/0/output", "x".into()), ("/glb", "yes".into())] {
        let mut broken = valid.clone();
        let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
        broken.pointer_mut(parent).expect("a parent")[key] = value;
        assert!(!validator.is_valid(&broken), "{pointer}");
    }
}
