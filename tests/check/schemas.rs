//! Tests that the schemas accept the outputs of the commands and refuse broken ones, and that the strict reader of the
//! extension agrees with its schema.

use std::collections::BTreeSet;
use std::fs;

use jsonschema::Validator;
use roughcast::NoteKind;
use roughcast::cli::Outcome;
use roughcast::gltf::roughness_pyramid::{EXTENSION, RoughnessPyramid};
use serde_json::{Value, json};

use crate::fixture::{bake, roughcast, write_asset};

pub fn schema(name: &str) -> Validator {
    let text = fs::read(format!("schemas/{name}.schema.json")).unwrap();
    let schema: Value = serde_json::from_slice(&text).unwrap();
    assert!(jsonschema::meta::is_valid(&schema), "{name}");
    assert_eq!(schema["$id"], format!("{name}.schema.json"));
    jsonschema::validator_for(&schema).unwrap()
}

pub fn assert_valid(schema: &Validator, value: &Value) {
    let errors: Vec<String> = schema.iter_errors(value).map(|e| format!("{}: {e}", e.instance_path())).collect();
    assert!(errors.is_empty(), "{errors:#?}\n{value:#}");
}

fn extension_of(options: &[&str]) -> Value {
    let bake = bake(options);
    let document: Value = serde_json::from_slice(&fs::read(bake.document()).unwrap()).unwrap();
    document["materials"][0]["extensions"][EXTENSION].clone()
}

#[test]
fn extensions_satisfy_their_schema_and_the_strict_reader() {
    let schema = schema(&format!("material.{EXTENSION}"));
    for model in ["none", "isotropic", "anisotropic"] {
        for (frame, name) in [("natural", "natural"), ("unit", "unit"), ("main-direction", "mainDirection")] {
            for target in ["basis", "float"] {
                let options = ["--profile", "pyramid", "--model", model, "--frame", frame, "--target", target];
                let extension = extension_of(&options);
                assert_valid(&schema, &extension);
                RoughnessPyramid::read(&extension).unwrap();
                assert_eq!(
                    (&extension["frame"], extension.get("roughnessModel").is_some()),
                    (&json!(name), model != "none")
                );
            }
        }
    }
}

/// The base lobe is recorded only where the core material has a roughened lobe.
#[test]
fn base_lobes_satisfy_the_schema_and_the_strict_reader() {
    let schema = schema(&format!("material.{EXTENSION}"));
    for (profile, model, is_recorded) in [
        ("both", "anisotropic", true),
        ("both", "isotropic", true),
        ("both", "none", false),
        ("pyramid", "isotropic", false),
    ] {
        let extension = extension_of(&["--profile", profile, "--model", model]);
        assert_valid(&schema, &extension);
        assert_eq!(RoughnessPyramid::read(&extension).unwrap().base_lobe.is_some(), is_recorded, "{profile}, {model}");
    }
}

#[test]
fn schema_and_strict_reader_refuse_the_same_values() {
    let schema = schema(&format!("material.{EXTENSION}"));
    let whole = json!({
        "formatVersion": 2,
        "offsetTexture": { "index": 1, "texCoord": 1, "extensions": { "KHR_texture_transform": { "scale": [2, 2] } } },
        "offsetChannels": 3, "offsetScale": [0.5, -0.5],
        "roughnessModel": "covarianceFactor",
        "roughnessTexture": { "index": 2 },
        "roughnessMin": [0, -1, 0], "roughnessMax": [1, 1, 1],
        "correctionFactor": 0.9,
        "frame": "mainDirection",
        "mainDirection": [0, 1, 0],
        "baseLobe": {
            "roughnessFactor": 0.5,
            "metallicRoughnessTexture": { "index": 0, "texCoord": 1 },
            "anisotropy": { "anisotropyStrength": 0.5, "anisotropyRotation": 1, "anisotropyTexture": { "index": 3 } }
        },
        "extras": { "note": 1 }
    });
    assert_valid(&schema, &whole);
    RoughnessPyramid::read(&whole).unwrap();
    let edits: &[(&str, Value)] = &[
        ("/offsetTexture", Value::Null),
        ("/offsetTexture", json!({})),
        ("/offsetTexture", json!({ "index": -1 })),
        ("/offsetTexture", json!({ "index": 1.5 })),
        ("/offsetTexture", json!({ "index": 1, "texcoord": 1 })),
        ("/formatVersion", json!(1)),
        ("/formatVersion", json!("2")),
        ("/formatVersion", json!(null)),
        ("/offsetChannels", json!(4)),
        ("/offsetChannels", json!("3")),
        ("/offsetScale", json!([0])),
        ("/offsetScale", json!([0, 0, 0])),
        ("/offsetScale", json!(["0", 0])),
        ("/roughnessModel", json!("lambda")),
        ("/roughnessModel", json!("standardDeviation")),
        ("/roughnessMin", json!([0])),
        ("/roughnessMax", json!([1, 1])),
        ("/correctionFactor", json!(-0.5)),
        ("/correctionFactor", json!("0.9")),
        ("/frame", json!("unit")),
        ("/frame", json!("tangent")),
        ("/mainDirection", json!([0, 1])),
        ("/roughnesstexture", json!({ "index": 2 })),
        ("/baseLobe", json!(1)),
        ("/baseLobe", json!({ "roughnessFactor": null })),
        ("/baseLobe", json!({ "metallicRoughnessTexture": 0 })),
        ("/baseLobe", json!({ "metallicFactor": 1 })),
        ("/baseLobe", json!({ "anisotropy": { "anisotropyTexture": null } })),
        ("/baseLobe", json!({ "anisotropy": { "strength": 1 } })),
    ];
    for (pointer, value) in edits {
        let mut broken = whole.clone();
        broken[&pointer[1..]] = value.clone();
        assert!(!schema.is_valid(&broken), "the schema accepts {pointer} = {value}");
        assert!(RoughnessPyramid::read(&broken).is_err(), "the reader accepts {pointer} = {value}");
    }
    for member in whole.as_object().unwrap().keys().filter(|k| !["extras", "baseLobe"].contains(&k.as_str())) {
        let mut broken = whole.clone();
        broken.as_object_mut().unwrap().remove(member);
        assert!(!schema.is_valid(&broken), "the schema does not require {member}");
        assert!(RoughnessPyramid::read(&broken).is_err(), "the reader does not require {member}");
    }
}

#[test]
fn bake_reports_satisfy_their_schema() {
    let schema = schema("report");
    let made = bake(&[]);
    fs::write(made.source.join("broken.gltf"), "{").unwrap();
    fs::write(made.source.join("flat.gltf"), r#"{"asset":{"version":"2.0"}}"#).unwrap();
    let output = made.baked.join("again");
    let paths = ["bake", made.source.to_str().unwrap(), "-o", output.to_str().unwrap(), "--json"];
    let (outcome, out, _) = roughcast(&[&paths[..], &["--profile", "both", "--frame", "main-direction"]].concat());
    assert_eq!(outcome, Outcome::Failed);
    let report: Value = serde_json::from_str(&out).unwrap();
    let statuses: Vec<&Value> = report["assets"].as_array().unwrap().iter().map(|a| &a["status"]).collect();
    assert_eq!(statuses, ["failed", "copied", "baked"]);
    assert_valid(&schema, &report);
    for (pointer, value) in [
        ("/assets/0/status", json!("baked")),
        ("/assets/2/status", json!("failed")),
        ("/assets/2/textures/0/content", json!("picture")),
        ("/assets/2/layers/0/notes", json!(["the bump map is a JPEG"])),
        ("/settings/target", json!("jpeg")),
        ("/version", json!(1)),
    ] {
        let mut broken = report.clone();
        *broken.pointer_mut(pointer).unwrap() = value;
        assert!(!schema.is_valid(&broken), "{pointer}");
    }
}

#[test]
fn the_schema_and_the_documents_list_all_kinds_of_notes() {
    let text = fs::read("schemas/report.schema.json").unwrap();
    let mut schema: Value = serde_json::from_slice(&text).unwrap();
    let listed: BTreeSet<String> =
        serde_json::from_value(schema["$defs"]["note"]["properties"]["kind"]["enum"].take()).unwrap();
    // The error on an unknown kind names all kinds between backquotes, after the unknown one.
    let error = serde_json::from_value::<NoteKind>(json!("unknown kind")).unwrap_err().to_string();
    let kinds: BTreeSet<String> = error.split('`').skip(3).step_by(2).map(str::to_owned).collect();
    assert_eq!(listed, kinds);
    let document = fs::read_to_string("docs/stability.md").unwrap();
    for kind in kinds {
        assert!(document.contains(&format!("\n| `{kind}` |")), "{kind}");
    }
}

#[test]
fn check_reports_satisfy_their_schema() {
    let schema = schema("check");
    let bake = bake(&["--gltf", "dual", "--target", "float"]);
    let (_, report) = bake.check(&[]);
    assert!(!report["findings"].as_array().unwrap().is_empty());
    assert_valid(&schema, &report);
    for (pointer, value) in
        [("/findings/0/code", json!("1205")), ("/findings/0/severity", json!("fatal")), ("/files", json!(1))]
    {
        let mut broken = report.clone();
        *broken.pointer_mut(pointer).unwrap() = value;
        assert!(!schema.is_valid(&broken), "{pointer}");
    }
}

#[test]
fn inspected_facts_satisfy_their_schema() {
    let schema = schema("inspect");
    let bake = bake(&["--profile", "both"]);
    fs::remove_file(bake.texture("bumps.offset.ktx2")).unwrap();
    for path in [bake.document(), bake.texture("bumps.normal.ktx2")] {
        let (_, out, _) = roughcast(&["inspect", path.to_str().unwrap(), "--json"]);
        let facts: Value = serde_json::from_str(&out).unwrap();
        assert_valid(&schema, &facts);
        let mut broken = facts.clone();
        broken["kind"] = json!("png");
        assert!(!schema.is_valid(&broken));
        let mut broken = facts.clone();
        broken["surplus"] = json!(1);
        assert!(!schema.is_valid(&broken));
    }
}

/// Returns the output of a command as JSON, whose first member is the format version.
fn json_of(arguments: &[&str]) -> Value {
    let (outcome, out, err) = roughcast(arguments);
    assert_eq!((outcome, err.as_str()), (Outcome::Done, ""), "{arguments:?}");
    let value: Value = serde_json::from_str(&out).unwrap();
    let members: Vec<&String> = value.as_object().unwrap().keys().collect();
    assert_eq!(members[0], "formatVersion", "{arguments:?}");
    value
}

fn assert_refused(schema: &Validator, value: &Value, edits: &[(&str, Value)]) {
    for (pointer, edit) in edits {
        let mut broken = value.clone();
        *broken.pointer_mut(pointer).unwrap() = edit.clone();
        assert!(!schema.is_valid(&broken), "{pointer}");
    }
}

#[test]
fn outputs_of_map_satisfy_their_schema() {
    let schema = schema("map");
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out.ktx2");
    let paths = ["map", "fixtures/maps/vgroove_normal.png", "-o", output.to_str().unwrap(), "--json"];
    let plain = json_of(&paths);
    assert_valid(&schema, &plain);
    assert!(plain.get("choice").is_none() && plain["textures"][0].get("range").is_none(), "{plain:#}");
    let both = json_of(&[&paths[..], &["--roughness-factor", "0.3", "--profile", "both"]].concat());
    assert_valid(&schema, &both);
    let textures = both["textures"].as_array().unwrap();
    assert!(textures.iter().any(|texture| texture.get("range").is_some()), "{both:#}");
    for texture in textures {
        let bytes = fs::metadata(texture["path"].as_str().unwrap()).unwrap().len();
        assert_eq!(texture["bytes"], bytes);
    }
    assert_refused(
        &schema,
        &both,
        &[
            ("/formatVersion", json!(2)),
            ("/model", json!("auto")),
            ("/choice", Value::Null),
            ("/choice/candidates/0/errors/0", json!(2)),
            ("/textures/0/content", json!("colour")),
            ("/textures/0/levels", json!(0)),
            ("/textures", json!([])),
        ],
    );
}

#[test]
fn outputs_of_render_satisfy_their_schema() {
    let schema = schema("render");
    let folder = tempfile::tempdir().unwrap();
    let (source, output) = (folder.path().join("source"), folder.path().join("output"));
    write_asset(&source);
    let input = source.join("ridges.gltf");
    let paths = ["render", input.to_str().unwrap(), "-o", output.to_str().unwrap(), "--json"];
    let scenes = ["--scene", "sphere,highlight", "--distance", "1,2", "--width", "8", "--samples", "2"];
    let report = json_of(&[&paths[..], &scenes].concat());
    assert_valid(&schema, &report);
    let rows = |sheet: usize| report["sheets"][sheet]["rows"].as_array().unwrap().len();
    assert_eq!((rows(0), rows(1)), (2, 0));
    assert_refused(
        &schema,
        &report,
        &[
            ("/formatVersion", json!(2)),
            ("/sheets/0/scene", json!("moon")),
            ("/sheets/0/scene", json!("highlight")),
            ("/sheets/1/scene", json!("plane")),
            ("/sheets/0/rows/0/distance", json!(0)),
            ("/sheets/0/rows/0/columns/0/name", json!("supersampled")),
            ("/sheets/0/rows/0/columns/0/relativeL1", Value::Null),
            ("/sheets/0/rows/0/crop/width", json!(0)),
            ("/sheets/0/rows/0/size", json!([8])),
            ("/gallery", Value::Null),
        ],
    );
}

#[test]
fn outputs_of_compare_satisfy_their_schema() {
    let schema = schema("compare");
    let folder = tempfile::tempdir().unwrap();
    let (source, output) = (folder.path().join("source"), folder.path().join("output"));
    write_asset(&source);
    let input = source.join("ridges.gltf");
    let paths = ["compare", input.to_str().unwrap(), "-o", output.to_str().unwrap()];
    let report = json_of(&[&paths[..], &["--texels", "1", "--picture-width", "8", "--json"]].concat());
    assert_valid(&schema, &report);
    let file: Value = serde_json::from_slice(&fs::read(output.join("compare.json")).unwrap()).unwrap();
    assert_eq!(file, report);
    assert_refused(
        &schema,
        &report,
        &[
            ("/formatVersion", json!(2)),
            ("/version", Value::Null),
            ("/materials/0/entries", json!([])),
            ("/materials/0/entries/0/kind", json!("theirs")),
            ("/materials/0/entries/0/levelErrors/0", json!(-1)),
            ("/materials/0/entries/0/fetches", json!(1.5)),
            ("/materials/0/entries/0/pictureError", json!(-1)),
            ("/materials/0/pictureNoise", json!("low")),
        ],
    );
}

/// Reports of `bake` and of `map` describe choices and textures with the same types.
#[test]
fn schemas_of_bake_and_map_agree() {
    let read = |name: &str| -> Value {
        serde_json::from_slice(&fs::read(format!("schemas/{name}.schema.json")).unwrap()).unwrap()
    };
    let (report, map) = (read("report"), read("map"));
    for pointer in [
        "/$defs/candidate",
        "/$defs/error",
        "/$defs/choice/required",
        "/$defs/choice/properties/candidates",
        "/$defs/choice/properties/misses/items",
        "/$defs/texture/required",
        "/$defs/texture/properties/range",
    ] {
        assert!(report.pointer(pointer).is_some() && report.pointer(pointer) == map.pointer(pointer), "{pointer}");
    }
    // A map has no colours.
    let contents = |schema: &Value| schema["$defs"]["texture"]["properties"]["content"]["enum"].clone();
    let mut of_assets = contents(&map);
    of_assets.as_array_mut().unwrap().extend([json!("colour"), json!("linear")]);
    assert_eq!(contents(&report), of_assets);
}
