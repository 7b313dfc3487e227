//! Tests the container of outputs: that of the input, or that of the document which `-o` names.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use super::process::{copy, done, files, fixtures, hashes, run};

/// Writes `brushed/brushed.gltf` and `waves/waves.glb` with their files.
fn scene() -> TempDir {
    let folder = tempdir().expect("a folder");
    for asset in ["brushed", "waves"] {
        copy(&fixtures().join(asset), &folder.path().join(asset));
    }
    folder
}

fn names(folder: &Path) -> Vec<String> {
    files(folder).into_iter().map(|(name, _)| name).collect()
}

fn gltf(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).expect("a document")).expect("JSON")
}

/// Returns JSON and BIN chunk of a .glb whose lengths and padding are as the specification demands.
fn glb(path: &Path) -> (Value, Vec<u8>) {
    let bytes = fs::read(path).expect("a document");
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")) as usize;
    assert_eq!((&bytes[..4], word(4), word(8)), (&b"glTF"[..], 2, bytes.len()));
    let (json_length, json_at) = (word(12), 20);
    assert_eq!((json_length % 4, &bytes[16..20]), (0, &b"JSON"[..]));
    let json: Value = serde_json::from_slice(&bytes[json_at..json_at + json_length]).expect("JSON");
    let bin_at = json_at + json_length + 8;
    assert_eq!((&bytes[bin_at - 4..bin_at], word(bin_at - 8)), (&b"BIN\0"[..], bytes.len() - bin_at));
    let bin = bytes[bin_at..].to_vec();
    let declared = json["buffers"][0]["byteLength"].as_u64().expect("a length") as usize;
    assert_eq!((json["buffers"].as_array().map(Vec::len), declared.next_multiple_of(4)), (Some(1), bin.len()));
    assert!(bin[declared..].iter().all(|byte| *byte == 0));
    (json, bin)
}

/// Returns how many images are KTX2 and how many are not, and checks that they are inside.
fn images(root: &Value, bin: &[u8]) -> (usize, usize) {
    let images = root["images"].as_array().expect("images");
    let is_ktx2 = |image: &&Value| {
        let view = &root["bufferViews"][image["bufferView"].as_u64().expect("a view") as usize];
        let start = view["byteOffset"].as_u64().unwrap_or(0) as usize;
        let starts_so = bin[start..].starts_with(b"\xabKTX 20\xbb");
        assert_eq!(image["mimeType"] == "image/ktx2", starts_so, "{image}");
        starts_so
    };
    let count = images.iter().filter(is_ktx2).count();
    (count, images.len() - count)
}

#[test]
fn a_glb_stays_one_file_with_ktx2_inside_and_no_png_copies() {
    let scene = scene();
    let folder = scene.path();
    done(folder, "bake waves -o out -q --model anisotropic");
    assert_eq!(names(&folder.join("out")), ["waves.glb"]);
    let (root, bin) = glb(&folder.join("out/waves.glb"));
    assert_eq!(root["extensionsRequired"], json!(["KHR_texture_basisu"]));
    // The base colour stays as it was.
    assert_eq!(images(&root, &bin), (3, 1));
    let colour = root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"].as_u64();
    for (index, texture) in (0..).zip(root["textures"].as_array().expect("textures")) {
        let is_colour = Some(index) == colour;
        assert_eq!(texture.get("source").is_some(), is_colour, "{texture}");
        assert_eq!(texture.pointer("/extensions/KHR_texture_basisu").is_some(), !is_colour, "{texture}");
    }
    done(folder, "check out --source waves --deep --allow RC1510");
    // Copies are there if they are asked for.
    done(folder, "bake waves -o copies -q --gltf fallback --model anisotropic");
    let (root, bin) = glb(&folder.join("copies/waves.glb"));
    assert_eq!((images(&root, &bin), root.get("extensionsRequired")), ((3, 4), None));
}

#[test]
fn a_named_glb_packs_the_files_of_a_gltf() {
    let scene = scene();
    let folder = scene.path();
    done(folder, "bake brushed/brushed.gltf -o out/packed.glb -q");
    assert_eq!(names(&folder.join("out")), ["packed.glb"]);
    let (root, bin) = glb(&folder.join("out/packed.glb"));
    assert_eq!(images(&root, &bin), (3, 1));
    assert_eq!(root["asset"]["extras"]["roughcast"]["source"], "brushed.gltf");
    // The buffer of the source comes first and is unchanged.
    let mesh = fs::read(folder.join("brushed/brushed.bin")).expect("a buffer");
    assert!(bin.starts_with(&mesh));
    done(folder, "check out/packed.glb --source brushed --deep --allow RC1510");
    done(folder, "check out --source brushed --deep --allow RC1510");
    fs::write(folder.join("brushed/brushed_normal.png"), "other bytes").expect("a file");
    let stale = run(folder, "check out/packed.glb --source brushed");
    assert!(stale.code == 3 && stale.out.contains("brushed_normal.png as it was baked"), "{}", stale.out);
}

/// Some exporters name KTX2 files as core sources, which glTF allows in no .glb.
#[test]
fn copied_ktx2_images_are_named_by_the_extension_in_a_glb() {
    let scene = scene();
    let folder = scene.path();
    done(folder, "bake brushed -o all -q --textures all");
    let is_colour = |name: &&String| name.contains("colour") && name.ends_with(".ktx2");
    let all = names(&folder.join("all"));
    let colour = all.iter().find(is_colour).expect("a base colour");
    fs::copy(folder.join("all").join(colour), folder.join("brushed/colour.ktx2")).expect("a copy");
    let path = folder.join("brushed/brushed.gltf");
    let document = fs::read_to_string(&path).expect("a document");
    fs::write(&path, document.replace("brushed_colour.png", "colour.ktx2")).expect("a file");
    done(folder, "bake brushed/brushed.gltf -o packed.glb -q");
    let (root, bin) = glb(&folder.join("packed.glb"));
    assert_eq!(images(&root, &bin), (4, 0));
    assert!(root["textures"].as_array().expect("textures").iter().all(|texture| texture.get("source").is_none()));
    assert_eq!(root["extensionsRequired"], json!(["KHR_texture_basisu"]));
    done(folder, "check packed.glb --deep --allow RC1510");
}

#[test]
fn a_named_gltf_writes_the_files_of_a_glb_beside_it() {
    let scene = scene();
    let folder = scene.path();
    done(folder, "bake waves/waves.glb -o out/lake.gltf -q");
    let found = names(&folder.join("out"));
    assert!(found.iter().all(|name| name == "lake.gltf" || name.starts_with("lake.roughcast/")), "{found:?}");
    for part in ["lake.roughcast/lake.bin", "lake.roughcast/Lake.roughness.ktx2"] {
        assert!(found.iter().any(|name| name == part), "{part} of {found:?}");
    }
    assert!(!found.iter().any(|name| name.ends_with(".png")), "{found:?}");
    assert_eq!(gltf(&folder.join("out/lake.gltf"))["buffers"][0]["uri"], "lake.roughcast/lake.bin");
    done(folder, "check out/lake.gltf --source waves --deep --allow RC1510");
}

#[test]
fn a_named_document_may_lie_beside_its_source() {
    let scene = scene();
    let folder = scene.path();
    let sources = hashes(folder);
    done(&folder.join("waves"), "bake waves.glb -o baked.glb -q");
    // Images that stay as they are need no copy.
    done(folder, "bake brushed/brushed.gltf -o brushed/baked.gltf -q");
    let after = hashes(folder);
    assert!(sources.iter().all(|(name, hash)| after.get(name) == Some(hash)));
    let new: Vec<&String> = after.keys().filter(|name| !sources.contains_key(*name)).collect();
    assert!(new.iter().all(|name| name.contains("baked.")), "{new:?}");
    done(folder, "check waves/baked.glb brushed/baked.gltf --deep --allow RC1510");
    // A second bake replaces the outputs, also with those of another source.
    done(folder, "bake waves/waves.glb -o brushed/baked.gltf -q --model none");
    for line in ["bake waves/waves.glb -o waves/waves.glb -q", "bake brushed/brushed.gltf -o brushed/brushed.gltf -q"] {
        let refused = run(folder, line);
        assert!(refused.code == 1 && refused.err.contains("source"), "{line}: {}", refused.err);
    }
    assert!(hashes(folder).iter().filter(|(name, _)| sources.contains_key(*name)).eq(sources.iter()));
}

#[test]
fn a_document_is_named_for_one_input_only() {
    let scene = scene();
    let folder = scene.path();
    fs::create_dir(folder.join("folder.glb")).expect("a folder");
    fs::write(folder.join("brushed/roughcast.toml"), "output = 'all.glb'\n").expect("a file");
    let before = hashes(folder);
    let both = "brushed/brushed.gltf waves/waves.glb";
    for (line, part) in [
        (format!("bake {both} -o out.glb"), "since -o names one file, found 2 inputs; name one file as the input"),
        ("bake waves -o out.glb".to_owned(), "found the folder waves; name one file as the input, or a folder with -o"),
        ("plan waves -o out.gltf".to_owned(), "found the folder waves"),
        ("watch waves -o out.glb".to_owned(), "expected a folder, found the name of a document"),
        ("watch missing -o out.glb".to_owned(), "expected a folder, found the name of a document"),
        ("bake waves/waves.glb -o folder.glb".to_owned(), "expected the name of a file, found a folder"),
        ("bake waves/waves.glb -o out.GLB".to_owned(), "name it out.glb"),
        ("bake waves/waves.glb -o out.glb --glb=false".to_owned(), "a name that suits --glb=false"),
        ("bake waves/waves.glb -o out.gltf --glb".to_owned(), "a name that suits --glb=true"),
        ("bake waves/waves.glb -o out.glb --engine bevy".to_owned(), "write a .gltf"),
        ("bake waves/waves.glb -o out.glb --gltf dual".to_owned(), "write a .gltf"),
        ("bake brushed".to_owned(), "expected a folder as `output`, found the document brushed/all.glb"),
    ] {
        let ended = run(folder, &line);
        assert_eq!((ended.code, ended.err.lines().count()), (2, 1), "{line}: {}", ended.err);
        assert!(ended.err.contains(part), "{line}: {}", ended.err);
    }
    assert_eq!(hashes(folder), before);
    assert!(!folder.join("out.glb").exists());
}

#[test]
fn presets_choose_the_container_that_their_engine_can_use() {
    let scene = scene();
    let folder = scene.path();
    for (engine, is_glb, has_copies) in
        [("three", true, false), ("filament", true, false), ("bevy", false, false), ("godot", false, true)]
    {
        done(folder, &format!("bake waves brushed -o {engine} -q --engine {engine}"));
        let names = names(&folder.join(engine));
        let has = |name: &str| names.iter().any(|other| other == name);
        assert_eq!((has("waves.glb"), has("waves.gltf")), (is_glb, !is_glb), "{engine}: {names:?}");
        assert!(has("brushed.gltf"));
        let copies = names.iter().filter(|name| name.contains(".roughcast/") && name.ends_with(".png")).count();
        assert_eq!(copies > 0, has_copies, "{engine}: {names:?}");
    }
    // The option wins over the preset.
    done(folder, "bake waves -o glb -q --engine godot --glb");
    assert_eq!(names(&folder.join("glb")), ["waves.glb"]);
}

#[test]
fn an_asset_without_bumps_changes_its_container_only_if_that_is_asked_for() {
    let scene = scene();
    let folder = scene.path();
    let strip = |path: &Path| {
        let mut root = gltf(path);
        root["materials"][0].as_object_mut().expect("a material").remove("normalTexture");
        fs::write(path, root.to_string()).expect("a file");
    };
    strip(&folder.join("brushed/brushed.gltf"));
    done(folder, "bake brushed/brushed.gltf -o out/plain.glb -q");
    assert_eq!(names(&folder.join("out")), ["plain.glb"]);
    let (root, bin) = glb(&folder.join("out/plain.glb"));
    assert_eq!(images(&root, &bin).0, 0);
    // And back again, into files of their own.
    let out = done(folder, "bake out/plain.glb -o back/plain.gltf");
    assert!(out.starts_with("copied out/plain.glb: no normal or height maps, "), "{out}");
    assert_eq!(names(&folder.join("back")), ["plain.gltf", "plain.roughcast/plain.bin"]);
    assert_eq!(fs::read(folder.join("back/plain.roughcast/plain.bin")).expect("a buffer"), bin[..bin_length(&root)]);
}

fn bin_length(root: &Value) -> usize {
    root["buffers"][0]["byteLength"].as_u64().expect("a length") as usize
}

#[test]
fn plans_caches_depfiles_and_reports_have_the_named_document() {
    let scene = scene();
    let folder = scene.path();
    let bake = "bake waves/waves.glb -o out/lake.glb -q --cache cache --depfile lake.d --report report.json";
    done(folder, bake);
    let first = hashes(&folder.join("out"));
    assert_eq!(first.keys().collect::<Vec<_>>(), ["lake.glb"]);
    assert_eq!(fs::read_to_string(folder.join("lake.d")).expect("a depfile"), "out/lake.glb: \\\n  waves/waves.glb\n");
    let report = gltf(&folder.join("report.json"));
    let asset = &report["assets"][0];
    assert_eq!((&asset["output"], &asset["status"]), (&json!("out/lake.glb"), &json!("baked")));
    assert_eq!(asset["inputBytes"], fs::metadata(folder.join("waves/waves.glb")).expect("a file").len());
    fs::remove_dir_all(folder.join("out")).expect("a folder");
    done(folder, bake);
    assert_eq!(gltf(&folder.join("report.json"))["assets"][0]["status"], "cached");
    assert_eq!(hashes(&folder.join("out")), first);
    // Another name is another job, since it is inside the outputs.
    fs::write(folder.join("plan.json"), done(folder, "plan waves/waves.glb -o out/lake.glb --json")).expect("a file");
    let plan = gltf(&folder.join("plan.json"));
    assert_eq!((&plan["jobs"][0]["name"], &plan["jobs"][0]["output"]), (&json!("lake"), &json!("out")));
    fs::remove_dir_all(folder.join("out")).expect("a folder");
    done(folder, "bake --plan plan.json -q");
    assert_eq!(hashes(&folder.join("out")), first);
    assert_ne!(gltf(&folder.join("report.json"))["assets"][0]["job"], json!(null));
}

/// Every byte of the outputs is counted once.
#[test]
fn sizes_are_those_of_the_files() {
    let scene = scene();
    let folder = scene.path();
    for options in ["", "--glb", "--glb=false", "--gltf fallback", "--gltf strict --profile both", "--model none"] {
        let report: Value =
            serde_json::from_str(&done(folder, &format!("bake brushed waves -o out --json {options}"))).expect("JSON");
        let written: u64 =
            files(&folder.join("out")).iter().map(|(_, path)| path.metadata().expect("facts").len()).sum();
        let assets = report["assets"].as_array().expect("assets");
        let sum = |member: &str| assets.iter().map(|asset| asset[member].as_u64().expect("a number")).sum::<u64>();
        assert_eq!(sum("bytes"), written, "{options}");
        let sizes = assets.iter().flat_map(|asset| asset["sizes"].as_object().expect("sizes").values());
        assert_eq!(sizes.map(|size| size.as_u64().expect("a number")).sum::<u64>(), written, "{options}");
        for asset in assets {
            let textures = asset["textures"].as_array().expect("textures").iter();
            let ktx2: u64 = textures.map(|texture| texture["bytes"].as_u64().expect("a number")).sum();
            assert_eq!(asset["sizes"]["ktx2"], ktx2, "{options}");
        }
        fs::remove_dir_all(folder.join("out")).expect("a folder");
    }
}

#[test]
fn several_assets_end_with_a_line_of_totals() {
    let scene = scene();
    let out = done(scene.path(), "bake brushed waves -o out");
    let lines: Vec<&str> = out.lines().filter(|line| !line.trim_start().starts_with("note: ")).collect();
    let starts = [
        "baked brushed/brushed.gltf: 1 material, ",
        "baked waves/waves.glb: 1 material, ",
        "total of 2 assets: 2 materials, ",
    ];
    assert_eq!(lines.len(), starts.len(), "{out}");
    for (line, start) in lines.iter().zip(starts) {
        assert!(line.starts_with(start) && line.contains(" -> ") && line.contains("(KTX2 "), "{line}");
    }
}
