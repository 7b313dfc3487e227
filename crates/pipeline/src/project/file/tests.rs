use std::path::Path;

use crate::project::file::*;
use crate::project::resolve::resolve;

fn parse(text: &str) -> Result<Config, ConfigError> {
    Config::parse(text, Path::new("roughcast.toml"))
}

fn message(text: &str) -> String {
    parse(text).expect_err(text).to_string()
}

/// Returns the value of the setting `name` that `text` gives to `asset`.
fn value(text: &str, asset: &str, name: &str) -> serde_json::Value {
    let sources = parse(text).expect(text).sources(Path::new(asset));
    members(&resolve(&sources).expect(text).values).remove(name).unwrap_or_default()
}

fn members(values: &Values) -> serde_json::Map<String, serde_json::Value> {
    let json = serde_json::to_string(values).expect("JSON");
    serde_json::from_str(&json).expect("an object")
}

#[test]
fn the_template_names_every_setting_with_its_default() {
    assert_eq!(parse(TEMPLATE).expect("comments").defaults, Values::default());
    // A comment that is a setting has no space after its sign.
    let lines = TEMPLATE.lines().filter_map(|l| l.strip_prefix('#').filter(|l| !l.starts_with(' ')));
    let config = parse(&lines.collect::<Vec<_>>().join("\n")).expect("settings");
    let written = members(&config.defaults);
    let names: std::collections::BTreeSet<String> = written.keys().cloned().collect();
    assert_eq!(names, Values::names().into_iter().collect());
    for (name, default) in members(&Values::defaults()) {
        assert_eq!(written[&name], default, "{name}");
    }
    assert_eq!((config.overrides.len(), config.output), (1, Some(PathBuf::from("../baked"))));
    let remote = serde_json::to_value(config.remote.expect("a server")).expect("JSON");
    assert!(RemoteValues::names().iter().all(|name| !remote[name].is_null()), "{remote}");
}

#[test]
fn a_server_is_named_by_a_table() {
    let remote = parse("[remote]\nurl = 'grpc://a:1'\nplatform = { OSFamily = 'linux' }\n").expect("a server").remote;
    assert_eq!(remote.expect("a server").platform.expect("a platform")["OSFamily"], "linux");
    assert!(
        message("[remote]\nurls = 'x'")
            .starts_with("line 2: expected the name of a setting, found \"urls\"; did you mean \"url\"")
    );
    assert!(message("\n[remote]\njobs = -1").starts_with("line 3: jobs: expected another value"));
    assert!(message("remote = 'grpc://a:1'").contains("not a table; write [remote]"));
}

#[test]
fn the_last_override_that_matches_wins() {
    let text = "quality = 'fast'\n[[override]]\nfiles = 'props/**'\nquality = 'best'\nmax-error = 0.5\n\
                [[override]]\nfiles = ['*_far.gltf', 'props/*/x.glb']\nmax-error = 1\n";
    for (asset, quality, max_error) in [
        ("a.gltf", "fast", 0.1),
        ("props/a.gltf", "best", 0.5),
        ("props/deep/er/a.gltf", "best", 0.5),
        ("props/a_far.gltf", "best", 1.0),
        ("a_far.gltf", "fast", 1.0),
        ("props/deep/x.glb", "best", 1.0),
        ("props/deep/er/x.glb", "best", 0.5),
    ] {
        assert_eq!(value(text, asset, "quality"), quality, "{asset}");
        assert_eq!(value(text, asset, "max-error").as_f64(), Some(max_error), "{asset}");
    }
}

#[test]
fn an_engine_sets_its_preset_beneath_other_values_of_its_source() {
    let text = "target = 'float'\nmodel = 'none'\n[[override]]\nfiles = 'a.gltf'\nengine = 'bevy'\n\
                [[override]]\nfiles = 'b.gltf'\nengine = 'godot'\nmodel = 'anisotropic'\n\
                [[override]]\nfiles = 'd.gltf'\nengine = 'babylon'\n\
                [[override]]\nfiles = 'e*.gltf'\nengine = 'three'\n\
                [[override]]\nfiles = 'e_far.gltf'\nprofile = 'pyramid'\n";
    let needs = |asset| ["target", "gltf", "model"].map(|name| value(text, asset, name));
    assert_eq!(needs("a.gltf"), ["basis", "dual", "isotropic"]);
    assert_eq!(needs("b.gltf"), ["basis", "fallback", "anisotropic"]);
    assert_eq!(needs("c.gltf"), ["float", "strict", "none"]);
    assert_eq!(needs("d.gltf"), ["basis", "strict", "isotropic"]);
    assert_eq!(needs("e.gltf"), ["basis", "strict", "isotropic"]);
    // A plugin shades this asset, not the shader of the engine.
    assert_eq!(needs("e_far.gltf"), ["basis", "strict", "anisotropic"]);
    assert_eq!(value(text, "a.gltf", "engine"), serde_json::Value::Null);
}

#[test]
fn unknown_keys_suggest_the_right_name() {
    for (text, line, right) in [
        ("\nmax_error = 1", 2, Some("max-error")),
        ("modle = 'auto'", 1, Some("model")),
        ("Distributions = 'auto'", 1, Some("distribution")),
        ("overide = []", 1, Some("override")),
        ("[[override]]\nfile = '*'\n", 2, Some("files")),
        ("[[override]]\nfiles = '*'\noutput = 'x'", 3, None),
        ("zzz = 1", 1, None),
    ] {
        match parse(text) {
            Err(ConfigError::UnknownKey { line: found, suggestion, .. }) => {
                assert_eq!((found, suggestion.as_deref()), (line, right), "{text}");
            }
            other => panic!("{text}: {other:?}"),
        }
    }
    assert!(message("modle = 'auto'").contains("did you mean \"model\""));
}

#[test]
fn wrong_values_are_reported_by_line() {
    for (text, parts) in [
        ("target = 'etc1s'", ["line 1: target", "`basis`"]),
        ("\n\nmax-error = 2", ["line 3: max-error", "0 to 1"]),
        ("rdo = 0", ["line 1: rdo", "above 0"]),
        ("rdo = 6.5", ["line 1: rdo", "up to 6"]),
        ("max-error = nan", ["line 1: max-error", "finite"]),
        ("glb = 'yes'", ["line 1: glb", "boolean"]),
        ("screen-height = -1", ["line 1: screen-height", "-1"]),
        ("max-texels = 99999999999999999999", ["line 1: max-texels", "finite"]),
        ("main-direction = [0, 1]", ["line 1: main-direction", "length 2"]),
        ("output = 1", ["line 1: output", "string"]),
        ("override = 1", ["line 1: override", "[[override]]"]),
        ("[[override]]\nglb = true", ["line 1: override", "files"]),
        ("[[override]]\nfiles = 1", ["line 2: files", "glob"]),
        ("[[override]]\nfiles = 'a{'", ["line 2: files", "a{"]),
        ("[target]\nx = 1", ["line 1: target", "finite"]),
        ("glb = true\nglb = false", ["expected TOML", "duplicate"]),
    ] {
        let message = message(text);
        assert!(parts.iter().all(|part| message.contains(part)), "{text}: {message}");
    }
}

#[test]
fn no_prefix_of_a_file_panics() {
    let text = "output = 'x'\nquality = 'best'\nmain-direction = [0, 1.5, -2e3]\n\
                [[override]]\nfiles = ['a/**', 'é*']\nglb = true\n";
    for end in (0..=text.len()).filter(|end| text.is_char_boundary(*end)) {
        let _ = parse(&text[..end]);
    }
}

#[test]
fn members_with_defaults_come_first() {
    let sources = parse("rdo = 1\nnearest = 2\nscreen-height = 3\n").expect("settings").sources(Path::new("a.gltf"));
    let set = members(&resolve(&sources).expect("settings").values);
    let names: Vec<&str> = set.keys().map(String::as_str).collect();
    let defaults = members(&Values::defaults());
    assert!(names.iter().copied().take(defaults.len()).eq(defaults.keys().map(String::as_str)), "{names:?}");
    assert_eq!(names[defaults.len()..], ["rdo", "nearest", "screen-height"]);
}

#[test]
fn a_table_of_settings_shows_the_origin_of_each() {
    let sources = parse("engine = 'bevy'\nrdo = 1\n").expect("settings").sources(Path::new("a.gltf"));
    let text = resolve(&sources).expect("settings").to_string();
    for line in
        ["model = \"isotropic\"", "max-error = 0.1 ", "rdo = 1.0 ", "main-direction = [0.0,1.0,0.0]", "gltf = \"dual\""]
    {
        assert!(text.contains(line), "{text}");
    }
    let origin = |name: &str| {
        let line = text.lines().find(|line| line.starts_with(name)).expect(name);
        line.split_once("# ").expect("an origin").1.to_owned()
    };
    assert_eq!(origin("gltf"), "roughcast.toml, engine = bevy");
    assert_eq!(origin("glb"), "roughcast.toml, engine = bevy");
    assert_eq!((origin("rdo").as_str(), origin("frame").as_str()), ("roughcast.toml", "default"));
}
