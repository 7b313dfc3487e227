//! The bakes whose outputs are golden: every combination of settings on a tiny asset, and larger assets with few
//! settings.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use rayon::prelude::*;
use roughcast::project::Engine;
use tempfile::tempdir;

use super::super::process::{done, files, fixtures};
use super::store::digest;

const PROFILES: [&str; 3] = ["portable", "pyramid", "both"];
const FORMS: [&str; 3] = ["fallback", "strict", "dual"];
const TARGETS: [&str; 3] = ["basis", "bc", "float"];
const FRAMES: [(&str, &str); 3] = [
    ("unit", "--frame unit"),
    ("natural", "--frame natural"),
    ("main-direction", "--frame main-direction --main-direction 1,2,0"),
];

/// Returns whether the output at `path` was baked for the target bc.
pub fn is_bc(path: &str) -> bool {
    path.split('/').nth(1).is_some_and(|case| case.split('-').any(|word| word == "bc"))
}

/// A bake.
struct Case {
    /// Path of its outputs in the list of golden files.
    name: String,
    /// Its command line below `fixtures/`, in which `OUT` is the folder of its outputs.
    line: String,
}

/// Returns the outputs of all cases by their paths, without copies of sources.
pub fn outputs() -> BTreeMap<String, Vec<u8>> {
    let read = |path: &Path| fs::read(path).expect("a readable file");
    let sources: BTreeSet<String> = files(&fixtures()).iter().map(|(_, path)| digest(&read(path))).collect();
    let outputs = |case: Case| {
        let folder = tempdir().expect("a folder");
        let line = case.line.replace("OUT", folder.path().to_str().expect("a path in UTF-8"));
        done(&fixtures(), &format!("{line} --no-provenance --threads 1"));
        let outputs =
            files(folder.path()).into_iter().map(|(name, path)| (format!("{}/{name}", case.name), read(&path)));
        outputs.filter(|(_, bytes)| !sources.contains(&digest(bytes))).collect::<Vec<_>>()
    };
    cases().into_par_iter().flat_map_iter(outputs).collect()
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |name: String, line: String| cases.push(Case { name, line });
    let targets = TARGETS.into_iter().filter(|target| cfg!(feature = "bc") || *target != "bc");
    for target in targets {
        for profile in PROFILES {
            for form in FORMS {
                for (frame, options) in FRAMES {
                    let settings = format!("--profile {profile} --gltf {form} --target {target} {options}");
                    add(format!("tiny/{profile}-{form}-{target}-{frame}"), format!("bake tiny -o OUT {settings}"));
                }
            }
            let settings = format!("--profile {profile} --target {target}");
            let name = format!("map/{profile}-{target}");
            let normals = "map tiny/cloth_normal.png --roughness tiny/cloth_surface.png -o OUT/normals.ktx2";
            add(name.clone(), format!("{normals} {settings}"));
            let heights = "map tiny/stone_height.png --height --roughness-factor 0.4 -o OUT/heights.ktx2";
            add(name, format!("{heights} {settings}"));
        }
    }
    for engine in Engine::names() {
        add(format!("engine/{engine}"), format!("bake tiny -o OUT --engine {engine} --profile both"));
    }
    for form in FORMS {
        for target in ["basis", "float"] {
            let settings = format!("--gltf {form} --target {target} --profile both");
            add(format!("large/{form}-{target}"), format!("bake brushed heights knobs waves -o OUT {settings}"));
        }
    }
    cases
}
