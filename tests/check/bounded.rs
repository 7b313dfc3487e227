//! Small files cause little work and short reports, whatever they contain.

use std::collections::BTreeMap;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use roughcast::check::{
    Code, Files, Findings, MAX_LISTED, ReferencedFiles, Report, Scope, Severity, Usage, check_document, check_texture,
    sarif, text,
};
use roughcast::codec::PayloadFormat;
use roughcast::codec::uastc::Effort;
use roughcast::gltf::document::Document;
use roughcast::inspect::{document_text, inspect_document, inspect_texture, texture_text};
use roughcast::ktx2::{Key, Ktx2Writer, StoredLevel};
use serde_json::{Value, json};

/// Files that are all a PNG of one texel, and how often each was read.
#[derive(Default)]
struct CountedFiles(Mutex<BTreeMap<PathBuf, usize>>);

fn png() -> Vec<u8> {
    let mut file = io::Cursor::new(Vec::new());
    image::RgbImage::from_pixel(1, 1, image::Rgb([128, 128, 255]))
        .write_to(&mut file, image::ImageFormat::Png)
        .unwrap();
    file.into_inner()
}

impl Files for CountedFiles {
    fn length(&self, _: &Path) -> io::Result<u64> {
        Ok(png().len() as u64)
    }

    fn read(&self, path: &Path, range: Range<u64>) -> io::Result<Vec<u8>> {
        *self.0.lock().unwrap().entry(path.to_owned()).or_default() += 1;
        Ok(png()[range.start as usize..range.end as usize].to_vec())
    }
}

/// Returns a document of `count` equal materials.
fn materials(count: usize, material: &Value) -> Value {
    json!({
        "asset": { "version": "2.0" },
        "images": [{ "uri": "a.png" }, { "uri": "b.png" }],
        "textures": [{ "source": 0 }, { "source": 1 }],
        "materials": vec![material; count]
    })
}

#[test]
fn reads_an_image_of_many_materials_once() {
    let material = json!({
        "normalTexture": { "index": 0 }, "pbrMetallicRoughness": { "metallicRoughnessTexture": { "index": 1 } }
    });
    let root = materials(10_000, &material);
    let document = Document::parse(root.to_string().as_bytes()).unwrap();
    let files = CountedFiles::default();
    let facts = inspect_document(&root, &ReferencedFiles::new(&document, &root, &files, true)).unwrap();
    assert_eq!(facts.materials.len(), 10_000);
    assert!(facts.materials.iter().all(|m| m.slots.len() == 2 && m.slots[1].images[0].picture.is_some()));
    assert_eq!(files.0.lock().unwrap().values().copied().collect::<Vec<_>>(), [1, 1]);
}

fn texture_with_keys(count: usize) -> Vec<u8> {
    let keys: Vec<Key> = (0..count).map(|n| Key { key: format!("k{n}"), value: String::new() }).collect();
    let levels = vec![StoredLevel::new(vec![0; 8], PayloadFormat::Rgba16Float, Effort::Fast).unwrap()];
    Ktx2Writer { format: PayloadFormat::Rgba16Float, width: 1, height: 1, levels, keys: &keys }.into_bytes().unwrap()
}

fn check(file: &[u8]) -> Vec<roughcast::check::Finding> {
    let mut findings = Findings::new("file.ktx2");
    check_texture(file, Usage::default(), &Scope::default(), &mut findings);
    findings.into_list()
}

/// Half a million keys are refused before they are listed.
#[test]
fn too_many_keys_are_one_finding() {
    let file = texture_with_keys(500_000);
    let found = check(&file);
    assert_eq!(found.iter().map(|f| f.code).collect::<Vec<_>>(), [Code::UnreadableTexture]);
    assert!(found[0].message.contains("more than 1000 keys"), "{found:?}");
    assert!(inspect_texture(&file).unwrap_err().to_string().contains("more than 1000 keys"));
    assert!(inspect_texture(&texture_with_keys(900)).is_ok());
}

/// Each key in the wrong order is a finding. The first findings are listed, and the rest are counted.
#[test]
fn lists_a_limited_number_of_findings_of_one_kind() {
    let mut file = texture_with_keys(900);
    let text = |n: usize| format!("k{n}\0").into_bytes();
    // Every second key of three digits is renamed so that it sorts before the previous key.
    for n in (100..900).step_by(2) {
        let (from, to) = (text(n), format!("a{n}\0").into_bytes());
        let at = file.windows(from.len()).position(|w| w == from).unwrap();
        file[at..at + to.len()].copy_from_slice(&to);
    }
    let found: Vec<_> = check(&file).into_iter().filter(|f| f.code == Code::KeyOrder).collect();
    assert_eq!(found.len(), MAX_LISTED + 1);
    assert!(
        found[MAX_LISTED].place.is_empty() && found[MAX_LISTED].message.contains(" more than the 20 above"),
        "{found:?}"
    );
    let report = Report { version: "1", files: vec!["file.ktx2".into()], findings: found, ..Report::default() };
    assert!(sarif(&report).unwrap().len() < 100_000);
}

/// The document has many primitives without tangents.
#[test]
fn limits_and_counts_the_findings_of_a_document() {
    let mut root = materials(2000, &json!({ "extensions": { "KHR_materials_anisotropy": {} } }));
    let primitives: Vec<Value> = (0..20_000).map(|n| json!({ "attributes": {}, "material": n % 2000 })).collect();
    root["meshes"] = json!([{ "primitives": primitives }]);
    let checked = check_document("a.gltf", root.to_string().as_bytes(), &CountedFiles::default(), &Scope::default());
    let found: Vec<_> = checked.findings.iter().filter(|f| f.code == Code::NoTangentSpace).collect();
    assert_eq!(found.len(), MAX_LISTED + 1, "{found:?}");
    assert!(found[MAX_LISTED].message.contains("19980 more"), "{:?}", found[MAX_LISTED]);
    assert_eq!(found[MAX_LISTED].severity, Severity::Error);
}

/// Names may contain characters that terminals and CI logs interpret.
#[test]
fn escapes_control_characters_in_names() {
    const HOSTILE: &str = "\u{1b}]0;title\u{7}\n::error::\u{9b}31m\u{202e}\u{2028}";
    let is_clean = |text: &str| {
        let is_unsafe = |c: char| (c.is_control() && c != '\n') || matches!(c, '\u{202e}' | '\u{2028}');
        !text.contains(is_unsafe) && !text.lines().any(|line| line.starts_with("::error::"))
    };
    let mut root = materials(1, &json!({ "name": HOSTILE, "normalTexture": { "index": 0 } }));
    root["extensionsUsed"] = json!([HOSTILE]);
    root["images"][0]["uri"] = json!(format!("data:image/png,{HOSTILE}"));
    root["textures"][1]["extensions"] = json!({ HOSTILE: { "source": 7 } });
    root["materials"][0]["extensions"] = json!({
        "ROUGHCAST_materials_roughness_pyramid": { HOSTILE: HOSTILE },
        "x": { "normalTexture": { "index": 1 } }
    });
    let document = Document::parse(root.to_string().as_bytes()).unwrap();
    let files = CountedFiles::default();
    let facts = inspect_document(&root, &ReferencedFiles::new(&document, &root, &files, true)).unwrap();
    let printed = document_text(HOSTILE, &facts);
    assert!(is_clean(&printed) && printed.contains("\\u{1b}]0;title"), "{printed:?}");

    let mut texture = inspect_texture(&texture_with_keys(1)).unwrap();
    texture.keys[0].key = HOSTILE.to_owned();
    assert!(is_clean(&texture_text(HOSTILE, &texture)));

    let checked = check_document(HOSTILE, root.to_string().as_bytes(), &files, &Scope::default());
    let report = Report { version: "1", files: vec![HOSTILE.into()], findings: checked.findings, ..Report::default() };
    let printed = text(&report);
    assert!(is_clean(&printed) && printed.contains("\\u{1b}]0;title"), "{printed:?}");
}
