//! Tests of charts and tables, with invented numbers.

use serde_json::{Value, json};

use super::labels::{LINE, stack};
use super::verdict::verdict;
use super::{Comparison, Cost, Entry, Kind, OURS, Ours, chart, compare, csv, page};
use crate::metric::Peer;
use crate::mip::Level;
use crate::render::{BaseAnisotropy, Bumps, LostBumps, Material, Texture};
use crate::report::LayerReport;

fn comparison(material: &str) -> Comparison {
    let entry = |i: u32, kind| Entry {
        name: format!("model {i}"),
        kind,
        chosen: i == 2,
        error: 0.02 * f64::from(i),
        level_errors: vec![0.0, 0.01 * f64::from(i)],
        picture_error: (kind != Kind::Oracle).then_some(0.03 * f64::from(i)),
        cost: Cost { gpu_bytes: (kind != Kind::Oracle).then_some(u64::from(1 + i) << 10), ..Cost::default() },
    };
    let kinds = (0..17).map(|i| (i, if i < 6 { Kind::Ours } else { Kind::Peer })).chain([(17, Kind::Oracle)]);
    Comparison {
        material: material.to_owned(),
        verdict: None,
        picture_noise: Some(0.02),
        entries: kinds.map(|(i, kind)| entry(i, kind)).collect(),
    }
}

#[test]
fn writes_one_row_for_each_entry_with_quoted_names() {
    let text = csv(&[comparison("a,\"b\"")]).unwrap();
    assert_eq!(text.lines().count(), 19);
    assert!(text.lines().skip(1).all(|line| line.starts_with("\"a,\"\"b\"\"\",model ")), "{text}");
    let columns = |line: &str| line.replace("\"a,\"\"b\"\"\"", "").matches(',').count();
    assert!(text.lines().all(|line| columns(line) == 12), "{text}");
}

#[test]
fn escapes_material_names_that_begin_like_formulas() {
    for name in ["=cmd|' /C calc'!A0", "+1", "-1", "@sum", "\tx"] {
        let text = csv(&[comparison(name)]).unwrap();
        assert!(text.lines().skip(1).all(|line| line.starts_with(&format!("'{name},model "))), "{text}");
    }
    let text = csv(&[comparison("\r=1,\"")]).unwrap();
    assert!(text.contains("\r\n\"'\r=1,\"\"\",model 0,"), "{text}");
}

#[test]
fn labels_every_entry_and_escapes_hostile_names() {
    let svg = chart(&comparison("<script>&\u{1}"));
    assert!(svg.contains("&lt;script&gt;&amp;\u{fffd}") && !svg.contains("<script"));
    for i in 0..17 {
        assert_eq!(svg.matches(&format!(">model {i}<")).count() + svg.matches(&format!(">model {i} (c")).count(), 3);
    }
    // The chosen entry is marked in the charts of both errors.
    assert_eq!(svg.matches("class=\"ring\"").count(), 2);
}

#[test]
fn every_chart_names_both_axes() {
    let svg = chart(&comparison("m"));
    for vertical in ["Mean lobe error: share", "Picture error: relative L1", ">Lobe error: share"] {
        assert_eq!(svg.matches(vertical).count(), 1, "{vertical}");
    }
    assert_eq!(svg.matches("(lower is better)").count(), 3);
    assert_eq!(svg.matches(">Size on the GPU, on a logarithmic scale<").count(), 2);
    assert_eq!(svg.matches(">Mip level (0 is the finest)<").count(), 1);
}

#[test]
fn labels_of_lines_keep_their_distance_and_stay_near() {
    assert_eq!(stack(&[50.0, 100.0], [0.0, 400.0]), [50.0, 100.0]);
    // Three labels that want one place lie around it, and labels at a border lie inside.
    assert_eq!(stack(&[100.0; 3], [0.0, 400.0]), [100.0 - LINE, 100.0, 100.0 + LINE]);
    assert_eq!(stack(&[400.0; 2], [0.0, 400.0]), [400.0 - LINE, 400.0]);
    let mut wanted: Vec<f64> = (0..20).map(|i| f64::from(i * i) % 83.0 + 4.0 * f64::from(i)).collect();
    wanted.sort_by(f64::total_cmp);
    let found = stack(&wanted, [0.0, 400.0]);
    assert!(found.windows(2).all(|pair| pair[1] - pair[0] > LINE - 1e-9), "{found:?}");
}

#[test]
fn the_page_begins_with_the_verdict() {
    let layer = |misses: Value| -> LayerReport {
        let candidate = |model, first| json!({ "model": model, "first": first, "bytes": 1, "errors": [0.05] });
        let candidates = [candidate("none", 0), candidate("isotropic", 0), candidate("isotropic", 1)];
        let choice = json!({ "finest": 0, "candidates": candidates, "chosen": 2, "misses": misses });
        let report = json!({ "index": 0, "material": "m", "layer": "base", "model": "isotropic", "notes": [],
            "choice": choice });
        serde_json::from_value(report).unwrap()
    };
    let mut comparison = comparison("helmet");
    comparison.entries[7].name = "plain mips".to_owned();
    let within = verdict(&comparison.entries, &layer(json!([])), 0.1).unwrap();
    assert_eq!(
        within,
        "Isotropic lobes at half size are the cheapest choice within 0.1 at every level: mean error 0.04, 3.1 kB on \
         the GPU. Plain mips: 0.14. Best possible lobe: 0.34. Picture error: 0.06, with plain mips 0.21."
    );
    let miss = json!([{ "level": 3, "error": 0.3, "oracle": 0.2, "reason": "twoPeaked" }]);
    let missed = verdict(&comparison.entries, &layer(miss), 0.1).unwrap();
    assert!(missed.starts_with("No choice is within 0.1 at every level; isotropic lobes at half size are"), "{missed}");
    let peer = comparison.entries.iter_mut().find(|entry| entry.kind == Kind::Peer).unwrap();
    (peer.name, peer.error) = ("LEAN".to_owned(), 0.03);
    let beside = verdict(&comparison.entries, &layer(json!([])), 0.1).unwrap();
    assert!(beside.contains("on the GPU. LEAN: 0.03. "), "{beside}");
    comparison.verdict = Some(within);
    let page = page(&[comparison], "0");
    let place = |text: &str| page.find(text).unwrap();
    assert!(place("<b>helmet</b>: Isotropic lobes") < place("<svg"));
    // The table has amounts with units.
    assert!(page.contains("<td>3.1 kB</td>"));
}

#[test]
fn a_comparison_without_pictures_has_no_chart_of_them() {
    let mut comparison = comparison("m");
    let page_with = page(&[comparison.clone()], "0");
    comparison.picture_noise = None;
    comparison.entries.iter_mut().for_each(|entry| entry.picture_error = None);
    let title = "m: picture error against size on the GPU";
    assert!(page_with.contains(title) && page_with.contains("a picture error of 0.020"));
    assert!(!page(&[comparison.clone()], "0").contains(title));
    assert!(!chart(&comparison).contains(title));
}

#[test]
fn draws_a_chart_without_entries() {
    let svg = chart(&Comparison { material: String::new(), verdict: None, picture_noise: None, entries: Vec::new() });
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
}

#[test]
fn every_measured_shader_has_its_cost() {
    let texture = || Texture::with_mips(Level { width: 4, height: 4, texels: vec![[0.5; 4]; 16] });
    let ours = |anisotropy| Ours {
        name: String::new(),
        material: Material {
            bumps: Bumps::Normals { texture: texture(), scale: 1.0, has_z: true },
            roughness: None,
            roughness_factor: 1.0,
            anisotropy,
            lost: LostBumps::RoughenedTextures,
        },
        file_bytes: 1,
        seconds: 1.0,
        chosen: false,
    };
    let anisotropy = BaseAnisotropy { texture: None, strength: 0.5, rotation: [1.0, 0.0] };
    let [plain, anisotropic] = [None, Some(anisotropy)].map(|anisotropy| Cost::of_bake(&ours(anisotropy)));
    assert!(plain.operations < anisotropic.operations && plain.fetches < anisotropic.fetches);
    for peer in Peer::ALL {
        let cost = Cost::of_peer(peer, &texture(), &texture(), true, &plain);
        let is_measured = !matches!(peer, Peer::LeanHalf | Peer::LeanFloat);
        assert_eq!((cost.operations.is_some(), cost.fetches.is_some()), (is_measured, is_measured), "{}", peer.name());
        assert!(cost.operations.is_none_or(|n| Some(n) >= plain.operations), "{}", peer.name());
    }
}

/// The levels are those of the finest texture. Plain mips have the mean roughness, as engines' mips of it have.
#[test]
fn a_roughness_texture_may_be_finer_than_the_normals() {
    let texture = |side: u32, texel: fn(u32) -> [f32; 4]| {
        Texture::with_mips(Level { width: side, height: side, texels: (0..side * side).map(texel).collect() })
    };
    let material = Material {
        bumps: Bumps::Normals { texture: texture(4, |_| [0.5, 0.5, 1.0, 1.0]), scale: 1.0, has_z: true },
        roughness: Some(texture(32, |i| [0.0, if i / 64 % 2 == 0 { 0.2 } else { 0.6 }, 0.0, 1.0])),
        roughness_factor: 1.0,
        anisotropy: None,
        lost: LostBumps::RoughenedTextures,
    };
    let ours = |material: &Material| {
        [(); OURS].map(|()| Ours {
            name: String::new(),
            material: material.clone(),
            file_bytes: 1,
            seconds: 1.0,
            chosen: false,
        })
    };
    let entries = compare("m", &material, ours(&material), 16, 0, &|_| {}).unwrap().entries;
    let plain = entries.iter().find(|entry| entry.name == "plain mips").unwrap();
    assert_eq!(plain.level_errors.len(), 6);
    // Stripes of two rows are lost at level 2.
    assert!(plain.level_errors[..2].iter().all(|error| *error < 1e-6), "{:?}", plain.level_errors);
    assert!(plain.level_errors[2..].iter().all(|error| *error > 0.2), "{:?}", plain.level_errors);
    for (peer, own) in plain.level_errors.iter().zip(&entries[0].level_errors) {
        assert!((peer - own).abs() < 1e-4, "{peer} {own}");
    }
    // Bumps are interpolated as samplers do it, in the truth as in the bakes.
    let bumps = texture(4, |i| [0.3 + 0.1 * (i % 5) as f32, 0.7 - 0.1 * (i % 3) as f32, 1.0, 1.0]);
    let bumpy = Material { bumps: Bumps::Normals { texture: bumps, scale: 1.0, has_z: true }, ..material };
    let entries = compare("m", &bumpy, ours(&bumpy), 1024, 0, &|_| {}).unwrap().entries;
    assert!(entries[0].level_errors[0] < 1e-6, "{:?}", entries[0].level_errors);
    assert!(entries[0].level_errors[1] < 0.1, "{:?}", entries[0].level_errors);
}
