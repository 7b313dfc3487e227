//! Small files make little work and short reports, whatever is in them.

use std::collections::BTreeMap;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use roughcast::check::{
    Code, Files, Findings, LISTED, Referred, Report, Scope, Severity, Usage, check_document, check_texture, sarif, text,
};
use roughcast::codec::Format;
use roughcast::codec::uastc::Effort;
use roughcast::gltf::document::Document;
use roughcast::inspect::{document_text, inspect_document, inspect_texture, texture_text};
use roughcast::ktx2::{Key, Ktx2Writer, StoredLevel};
use serde_json::{Value, json};

/// A PNG of one texel at every path, and how often each was read.
#[derive(Default)]
struct Counted(Mutex<BTreeMap<PathBuf, usize>>);

fn png() -> Vec<u8> {
    let mut file = io::Cursor::new(Vec::new());
    image::RgbImage::from_pixel(1, 1, image::Rgb([128, 128, 255]))
        .write_to(&mut file, image::ImageFormat::Png)
        .unwrap();
    file.into_inner()
}

impl Files for Counted {
    fn length(&self, _: &Path) -> io::Result<u64> {
        Ok(png().len() as u64)
    }

    fn read(&self, path: &Path, range: Range<u64>) -> io::Result<Vec<u8>> {
        *self.0.lock().unwrap().entry(path.to_owned()).or_default() += 1;
        Ok(png()[range.start as usize..range.end as usize].to_vec())
    }
}

/// A document of `count` equal materials.
fn materials(count: usize, material: &Value) -> Value {
    json!({
        "asset": { "version": "2.0" },
        "images": [{ "uri": "a.png" }, { "uri": "b.png" }],
        "textures": [{ "source": 0 }, { "source": 1 }],
        "materials": vec![material; count]
    })
}

#[test]
fn images_that_many_materials_share_are_read_once() {
    let material = json!({
        "normalTexture": { "index": 0 }, "pbrMetallicRoughness": { "metallicRoughnessTexture": { "index": 1 } }
    });
    let root = materials(10_000, &material);
    let document = Document::parse(root.to_string().as_bytes()).unwrap();
    let files = Counted::default();
    let facts = inspect_document(&root, &Referred::new(&document, &root, &files, true)).unwrap();
    assert_eq!(facts.materials.len(), 10_000);
    assert!(facts.materials.iter().all(|m| m.slots.len() == 2 && m.slots[1].images[0].picture.is_some()));
    assert_eq!(files.0.lock().unwrap().values().copied().collect::<Vec<_>>(), [1, 1]);
}

fn keyed(count: usize) -> Vec<u8> {
    let keys: Vec<Key> = (0..count).map(|n| Key { key: format!("k{n}"), value: String::new() }).collect();
    let levels = vec![StoredLevel::new(vec![0; 8], Format::Rgba16Float, Effort::Fast).unwrap()];
    Ktx2Writer { format: Format::Rgba16Float, width: 1, height: 1, levels, keys: &keys }.into_bytes().unwrap()
}

fn check(file: &[u8]) -> Vec<roughcast::check::Finding> {
    let mut findings = Findings::new("file.ktx2");
    check_texture(file, Usage::default(), &Scope::default(), &mut findings);
    findings.into_list()
}

/// Half a million keys are refused before anybody lists them.
#[test]
fn more_keys_than_anybody_needs_are_one_finding() {
    let file = keyed(500_000);
    let found = check(&file);
    assert_eq!(found.iter().map(|f| f.code).collect::<Vec<_>>(), [Code::UnreadableTexture]);
    assert!(found[0].message.contains("more than 1000 keys"), "{found:?}");
    assert!(inspect_texture(&file).unwrap_err().to_string().contains("more than 1000 keys"));
    assert!(inspect_texture(&keyed(900)).is_ok());
}

/// Keys in the wrong order, each a finding: the first are listed and the rest are counted.
#[test]
fn findings_of_one_kind_are_listed_up_to_a_number() {
    let mut file = keyed(900);
    let text = |n: usize| format!("k{n}\0").into_bytes();
    // Every second key of three digits becomes less than the one before.
    for n in (100..900).step_by(2) {
        let (from, to) = (text(n), format!("a{n}\0").into_bytes());
        let at = file.windows(from.len()).position(|w| w == from).unwrap();
        file[at..at + to.len()].copy_from_slice(&to);
    }
    let found: Vec<_> = check(&file).into_iter().filter(|f| f.code == Code::KeyOrder).collect();
    assert_eq!(found.len(), LISTED + 1);
    assert!(found[LISTED].place.is_empty() && found[LISTED].message.contains(" more than the 20 above"), "{found:?}");
    let report = Report { version: "1", files: vec!["file.ktx2".into()], findings: found };
    assert!(sarif(&report).unwrap().len() < 100_000);
}

/// As many primitives without tangents as a small file can have.
#[test]
fn findings_of_a_document_are_bounded_and_counted() {
    let mut root = materials(2000, &json!({ "extensions": { "KHR_materials_anisotropy": {} } }));
    let primitives: Vec<Value> = (0..20_000).map(|n| json!({ "attributes": {}, "material": n % 2000 })).collect();
    root["meshes"] = json!([{ "primitives": primitives }]);
    let checked = check_document("a.gltf", root.to_string().as_bytes(), &Counted::default(), &Scope::default());
    let found: Vec<_> = checked.findings.iter().filter(|f| f.code == Code::NoTangentSpace).collect();
    assert_eq!(found.len(), LISTED + 1, "{found:?}");
    assert!(found[LISTED].message.contains("19980 more"), "{:?}", found[LISTED]);
    assert_eq!(found[LISTED].severity, Severity::Error);
}

/// Names may hold what terminals and logs of CI servers act upon.
#[test]
fn control_characters_of_names_are_escaped() {
    const HOSTILE: &str = "\u{1b}]0;title\u{7}\n::error::\u{9b}31m\u{202e}\u{2028}";
    let is_clean = |text: &str| {
        let unfit = |c: char| (c.is_control() && c != '\n') || matches!(c, '\u{202e}' | '\u{2028}');
        !text.contains(unfit) && !text.lines().any(|line| line.starts_with("::error::"))
    };
    let mut root = materials(1, &json!({ "name": HOSTILE, "normalTexture": { "index": 0 } }));
    root["extensionsUsed"] = json!([HOSTILE]);
    root["images"][0]["uri"] = json!(format!("data:image/png,{HOSTILE}"));
    root["textures"][1]["extensions"] = json!({ HOSTILE: { "source": 7 } });
    root["materials"][0]["extensions"] = json!({ "ROUGHCAST_materials_roughness_pyramid": { HOSTILE: HOSTILE }, "x": { "normalTexture": { "index": 1 } } });
    let document = Document::parse(root.to_string().as_bytes()).unwrap();
    let files = Counted::default();
    let facts = inspect_document(&root, &Referred::new(&document, &root, &files, true)).unwrap();
    let printed = document_text(HOSTILE, &facts);
    assert!(is_clean(&printed) && printed.contains("\\u{1b}]0;title"), "{printed:?}");

    let mut texture = inspect_texture(&keyed(1)).unwrap();
    texture.keys[0].key = HOSTILE.to_owned();
    assert!(is_clean(&texture_text(HOSTILE, &texture)));

    let checked = check_document(HOSTILE, root.to_string().as_bytes(), &files, &Scope::default());
    let report = Report { version: "1", files: vec![HOSTILE.into()], findings: checked.findings };
    let printed = text(&report);
    assert!(is_clean(&printed) && printed.contains("\\u{1b}]0;title"), "{printed:?}");
}
