//! An attack by a hostile cache: entries and blobs are damaged and forged, with valid checksums.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::{Value, json};
use tempfile::tempdir;
use walkdir::WalkDir;

use super::random::Random;

/// Number of damaged caches in a run.
const ROUNDS: u64 = 40;

/// Bytes of an entry before its JSON: the BLAKE3 hash of the JSON in hexadecimal digits.
const CHECKSUM: usize = 64;

fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let entries = WalkDir::new(folder).sort_by_file_name().into_iter().map(|entry| entry.expect("an entry"));
    let files = entries.filter(|entry| entry.file_type().is_file()).map(|entry| entry.path().to_owned());
    files.map(|path| (path.clone(), fs::read(path).expect("a readable file"))).collect()
}

fn bake(folder: &Path) -> (i32, String) {
    let run = Command::new(env!("CARGO_BIN_EXE_roughcast"))
        .current_dir(folder)
        .args(["bake", "assets", "-o", "out", "--cache", "cache", "--model", "isotropic", "--quiet"])
        .output()
        .expect("the command starts");
    (run.status.code().unwrap_or(-1), String::from_utf8_lossy(&run.stderr).into_owned())
}

/// Changes a path, a digest, a length or any other member of an entry, and updates its checksum.
fn forge(random: &mut Random, entry: &mut Vec<u8>, victim: &Path) {
    let Some(mut tree) = entry.get(CHECKSUM..).and_then(|json| serde_json::from_slice::<Value>(json).ok()) else {
        return;
    };
    let victim = victim.to_string_lossy().into_owned();
    let texts = [
        json!(victim),
        json!(format!("../../../..{victim}")),
        json!("../assets/waves.glb"),
        json!("../escaped.txt"),
        json!("a/../../escaped.txt"),
        json!(""),
        json!("."),
        json!("\u{0}"),
        json!("0".repeat(64)),
        json!("A".repeat(64)),
        json!(-1),
        json!(u64::MAX),
        json!(null),
        json!([]),
    ];
    for _ in 0..=random.below(2) {
        let pointers = pointers(&tree, "");
        let pointer = random.pick(&pointers).clone();
        if let Some(value) = tree.pointer_mut(&pointer) {
            *value = random.pick(&texts).clone();
        }
    }
    let json = tree.to_string();
    *entry = [blake3::hash(json.as_bytes()).to_hex().as_bytes(), json.as_bytes()].concat();
}

/// Returns the JSON pointers of all values in `tree`.
fn pointers(tree: &Value, at: &str) -> Vec<String> {
    let below = match tree {
        Value::Object(members) => members.iter().map(|(key, value)| (key.clone(), value)).collect(),
        Value::Array(items) => items.iter().enumerate().map(|(index, item)| (index.to_string(), item)).collect(),
        _ => Vec::new(),
    };
    let below = below.into_iter().flat_map(|(key, value)| pointers(value, &format!("{at}/{key}")));
    [at.to_owned()].into_iter().chain(below).collect()
}

#[test]
fn a_forged_cache_does_not_change_outputs() {
    let folder = tempdir().expect("a folder");
    let folder = folder.path();
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures");
    for asset in ["brushed", "waves"] {
        fs::create_dir_all(folder.join("assets").join(asset)).expect("a folder");
        for (path, bytes) in files(&fixtures.join(asset)) {
            let name = path.file_name().expect("a name");
            fs::write(folder.join("assets").join(asset).join(name), bytes).expect("a file");
        }
    }
    let victim = folder.join("victim.txt");
    fs::write(&victim, "precious").expect("a file");
    assert_eq!(bake(folder), (0, String::new()));
    let (wanted, cache) = (files(&folder.join("out")), files(&folder.join("cache")));
    let sources = files(&folder.join("assets"));
    for seed in 0..ROUNDS {
        let mut random = Random::new(seed);
        for (path, bytes) in &cache {
            let mut bytes = bytes.clone();
            match random.below(3) {
                0 => forge(&mut random, &mut bytes, &victim),
                1 => super::mutate::bytes(&mut random, &mut bytes),
                _ => {}
            }
            fs::write(path, bytes).expect("a file of the cache");
        }
        if random.below(2) == 0 {
            fs::remove_dir_all(folder.join("out")).expect("the outputs");
        }
        let (code, err) = bake(folder);
        assert_eq!(code, 0, "seed {seed}: {err}");
        assert!(err.lines().all(|line| line.starts_with("warning: ")), "seed {seed}: {err}");
        assert!(files(&folder.join("out")) == wanted, "seed {seed}: outputs differ; {err}");
        assert!(files(&folder.join("assets")) == sources, "seed {seed}: a source changed");
        assert_eq!(fs::read_to_string(&victim).ok().as_deref(), Some("precious"), "seed {seed}");
        let mut names: Vec<_> =
            fs::read_dir(folder).expect("a folder").map(|e| e.expect("an entry").file_name()).collect();
        names.sort();
        assert_eq!(names, ["assets", "cache", "out", "victim.txt"], "seed {seed}");
    }
}
