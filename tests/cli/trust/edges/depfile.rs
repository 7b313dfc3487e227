//! Tests of `--depfile` with any file names: either Make and Ninja run only the rule and miss no change, or the bake
//! fails.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, SystemTime};

use proptest::prelude::*;
use tempfile::tempdir;

use crate::process::{copy, files, fixtures, roughcast_in, run};
use crate::skip::missing_tool;

/// Returns a tool as a build starts it: in English, and without variables of the test run.
fn tool(name: &str, folder: &Path) -> Command {
    let mut command = Command::new(name);
    command.current_dir(folder).env("LC_ALL", "C").env_remove("MAKEFLAGS").env_remove("MAKELEVEL");
    command
}

fn text(output: &Output) -> String {
    [&output.stdout[..], &output.stderr].map(String::from_utf8_lossy).concat()
}

/// Sets the time of a file, in seconds after 1970.
fn set_time(path: &Path, seconds: u64) {
    let file = File::open(path).expect("a file");
    file.set_modified(SystemTime::UNIX_EPOCH + Duration::from_secs(seconds)).expect("a time");
}

fn has_ninja() -> bool {
    let is_installed = Command::new("ninja").arg("--version").output().is_ok();
    if !is_installed {
        missing_tool("tests of depfiles need Ninja (Debian: `ninja-build`)");
    }
    is_installed
}

/// Renames an image of the brushed sphere in `assets`, and its URI with it.
fn rename_image(assets: &Path, name: &str, uri: &str) {
    fs::rename(assets.join("brushed_colour.png"), assets.join(name)).expect("a file");
    let document = assets.join("brushed.gltf");
    let text = fs::read_to_string(&document).expect("a document");
    fs::write(document, text.replace("brushed_colour.png", uri)).expect("a file");
}

/// Runs the Makefile of docs/pipeline.md.
#[test]
fn a_name_that_is_a_make_command_is_refused_and_not_run() {
    let folder = tempdir().expect("a folder");
    let folder = folder.path();
    let assets = folder.join("assets");
    copy(&fixtures().join("brushed"), &assets);
    let makefile = format!(
        "baked/brushed.gltf: assets/brushed.gltf\n\t{} bake $< -o baked --depfile $@.d -q --model none\n-include baked/brushed.gltf.d\n",
        env!("CARGO_BIN_EXE_roughcast")
    );
    fs::write(folder.join("Makefile"), makefile).expect("a file");
    let make = || tool("make", folder).output().expect("make starts");
    let (baked, up_to_date) = (make(), make());
    assert!(baked.status.success() && text(&up_to_date).contains("is up to date"), "{}", text(&baked));
    for changed in ["brushed.gltf", "brushed_normal.png"] {
        set_time(&assets.join(changed), 4_000_000_000);
        assert!(text(&make()).contains(" bake assets/brushed.gltf"), "a change of {changed} is missed");
        set_time(&assets.join(changed), 1_000_000_000);
    }
    assert!(text(&make()).contains("is up to date"));
    // Make would stop at the missing image.
    fs::remove_file(folder.join("baked/brushed.gltf.d")).expect("the rules of the last bake");
    rename_image(&assets, "a;touch${IFS}PWNED;b.png", "a%3Btouch%24%7BIFS%7DPWNED%3Bb.png");
    fs::write(assets.join("a"), "").expect("a file");
    set_time(&assets.join("brushed.gltf"), 4_000_000_000);
    for _ in 0..3 {
        let refused = make();
        let message = text(&refused);
        assert!(
            !refused.status.success() && message.contains("found ';' in assets/a;touch${IFS}PWNED;b.png"),
            "{message}"
        );
        assert!(message.contains("rename the file"), "{message}");
    }
    assert!(!folder.join("PWNED").exists() && !assets.join("PWNED").exists());
}

#[test]
fn an_asset_without_a_rule_fails_alone() {
    let folder = tempdir().expect("a folder");
    let folder = folder.path();
    copy(&fixtures().join("waves"), &folder.join("A/good"));
    copy(&fixtures().join("waves"), &folder.join("A/b=d"));
    let run = run(folder, "bake A -o O -q --model none --depfile d --report r.json");
    let expected = "error: A/b=d/waves.glb: --depfile: expected a path that Make and Ninja can read, found '=' in \
                    O/b=d/waves.glb; rename the file or its folder, or leave --depfile out\n";
    assert_eq!((run.code, run.err.as_str()), (1, expected));
    assert_eq!(fs::read_to_string(folder.join("d")).expect("a file"), "O/good/waves.glb: \\\n  A/good/waves.glb\n");
    assert!(folder.join("O/good/waves.glb").is_file() && !folder.join("O/b=d").exists());
    let report: serde_json::Value =
        serde_json::from_slice(&fs::read(folder.join("r.json")).expect("a file")).expect("JSON");
    let failed = &report["assets"][0];
    assert_eq!((&failed["input"], &failed["status"]), (&"A/b=d/waves.glb".into(), &"failed".into()), "{report:#}");
}

/// Words with a meaning for Make at the start of a line.
const DIRECTIVES: &[&str] = &["include", "-include", "define", "export", "ifeq", "else", "override", "vpath", ".PHONY"];

/// Names for a folder, an asset without its extension, and two images.
#[derive(Clone, Debug)]
struct Names {
    folder: String,
    stem: String,
    images: [String; 2],
}

/// Returns names that most file systems allow. A depfile allows many of them, too.
fn name() -> impl Strategy<Value = String> {
    let mild = "[ #%~(){}&'\"!,+@a-cé._-]{1,5}";
    let hostile = "[ #$%:;=|*?<>^`~()\\[\\]{}\\\\&'\"!,+@a-cé\u{7f}\n\t\r._-]{1,6}";
    let directive = (prop::sample::select(DIRECTIVES), "[ :=a#]{0,3}").prop_map(|(word, rest)| word.to_owned() + &rest);
    let name = prop_oneof![6 => mild, 3 => hostile, 1 => directive];
    name.prop_filter("a name of a file", |name| name != "." && name != "..")
}

fn names() -> impl Strategy<Value = Names> {
    let names = (name(), name(), name(), name());
    let names = names.prop_map(|(folder, stem, a, b)| Names { folder, stem, images: [a, b] });
    names.prop_filter("names of four files", |names| names.images[0] != names.images[1])
}

/// Writes a folder in which an asset of `names` is baked without textures to encode. Returns its inputs and the output.
fn asset(folder: &Path, names: &Names) -> (Vec<PathBuf>, PathBuf) {
    let encoded = |name: &String| name.bytes().map(|byte| format!("%{byte:02X}")).collect::<String>();
    let images: Vec<_> = names.images.iter().map(|name| serde_json::json!({ "uri": encoded(name) })).collect();
    let document = serde_json::json!({ "asset": { "version": "2.0" }, "images": images });
    let assets = Path::new("assets").join(&names.folder);
    let source = assets.join(format!("{}.gltf", names.stem));
    fs::create_dir_all(folder.join(&assets)).expect("a folder");
    for image in &names.images {
        fs::copy(fixtures().join("maps/line_normal.png"), folder.join(&assets).join(image)).expect("a file");
    }
    fs::write(folder.join(&source), document.to_string()).expect("a file");
    let inputs = names.images.iter().map(|image| assets.join(image)).chain([source]).collect();
    (inputs, Path::new("baked").join(&names.folder).join(format!("{}.gltf", names.stem)))
}

/// Expects that `asks`, which returns whether a build system would bake again, notices every change of an input and
/// nothing else.
fn assert_notices(folder: &Path, inputs: &[PathBuf], asks: &dyn Fn() -> bool) -> Result<(), TestCaseError> {
    prop_assert!(!asks(), "nothing changed");
    for input in inputs {
        set_time(&folder.join(input), 1_400_000_000);
        prop_assert!(asks(), "a change of {input:?} is missed");
        set_time(&folder.join(input), 1_000_000_000);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn no_change_is_missed_and_nothing_else_runs_for_any_file_names(names in names()) {
        let folder = tempdir().expect("a folder");
        let folder = folder.path();
        let (inputs, output) = asset(folder, &names);
        let run = roughcast_in(folder, ["bake", "assets", "-o", "baked", "-q", "--no-config", "--depfile", "d"]);
        let rules = fs::read_to_string(folder.join("d")).unwrap_or_default();
        if run.code != 0 {
            let is_refused = run.err.contains("--depfile: expected") && run.err.contains("rename the file");
            // Names that a URI cannot contain are refused earlier.
            prop_assert!(is_refused || run.err.contains("expected a file name without"), "{}", run.err);
            prop_assert_eq!((run.code, rules.as_str()), (1, ""));
            return Ok(());
        }
        for input in &inputs {
            set_time(&folder.join(input), 1_000_000_000);
        }
        set_time(&folder.join(&output), 1_200_000_000);
        let target = output.to_str().expect("UTF-8");
        fs::write(folder.join("Makefile"), "%.gltf:\n\t@echo RULE\ninclude d\n").expect("a file");
        let ninja = target.replace('$', "$$").replace(' ', "$ ").replace(':', "$:");
        let ninja = format!("rule r\n  command = echo RULE\n  depfile = d\nbuild {ninja}: r\n");
        fs::write(folder.join("build.ninja"), ninja).expect("a file");
        let list = || files(folder).into_iter().map(|(name, _)| name).collect::<BTreeSet<_>>();
        let before = list();
        let make = || {
            let output = tool("make", folder).args(["--no-print-directory", "--", target]).output().expect("make starts");
            assert!(output.status.success(), "{}\n{rules}", text(&output));
            let is_asked = output.stdout == b"RULE\n";
            assert!(is_asked || text(&output) == format!("make: '{target}' is up to date.\n"), "{}\n{rules}", text(&output));
            is_asked
        };
        assert_notices(folder, &inputs, &make)?;
        prop_assert_eq!(list(), before);
        if has_ninja() {
            let ninja = |arguments: &[&str]| {
                let output = tool("ninja", folder).args(arguments).output().expect("ninja starts");
                assert!(output.status.success(), "{}\n{rules}", text(&output));
                !text(&output).contains("no work to do")
            };
            // Ninja runs once to write its log.
            ninja(&[]);
            assert_notices(folder, &inputs, &|| ninja(&["-n"]))?;
        }
    }
}
