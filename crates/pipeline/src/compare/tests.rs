//! Tests of charts and tables, with invented numbers.

use super::{Comparison, Cost, Entry, Kind, Ours, chart, csv};
use crate::metric::Peer;
use crate::mip::Level;
use crate::render::{BaseAnisotropy, Bumps, LostBumps, Material, Texture};

fn comparison(material: &str) -> Comparison {
    let entry = |i: u32, kind| Entry {
        name: format!("model {i}"),
        kind,
        chosen: i == 2,
        error: 0.02 * f64::from(i),
        level_errors: vec![0.0, 0.01 * f64::from(i)],
        cost: Cost { gpu_bytes: (kind != Kind::Oracle).then_some(u64::from(1 + i) << 10), ..Cost::default() },
    };
    let kinds = (0..17).map(|i| (i, if i < 6 { Kind::Ours } else { Kind::Peer })).chain([(17, Kind::Oracle)]);
    Comparison { material: material.to_owned(), entries: kinds.map(|(i, kind)| entry(i, kind)).collect() }
}

#[test]
fn writes_one_row_for_each_entry_with_quoted_names() {
    let text = csv(&[comparison("a,\"b\"")]).unwrap();
    assert_eq!(text.lines().count(), 19);
    assert!(text.lines().skip(1).all(|line| line.starts_with("\"a,\"\"b\"\"\",model ")), "{text}");
    let columns = |line: &str| line.replace("\"a,\"\"b\"\"\"", "").matches(',').count();
    assert!(text.lines().all(|line| columns(line) == 11), "{text}");
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
        assert_eq!(svg.matches(&format!(">model {i}<")).count() + svg.matches(&format!(">model {i} (c")).count(), 2);
    }
    assert_eq!(svg.matches("class=\"ring\"").count(), 1);
}

#[test]
fn draws_a_chart_without_entries() {
    let svg = chart(&Comparison { material: String::new(), entries: Vec::new() });
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
        let cost = Cost::of_peer(peer, &texture(), true, &plain);
        let is_measured = !matches!(peer, Peer::LeanHalf | Peer::LeanFloat);
        assert_eq!((cost.operations.is_some(), cost.fetches.is_some()), (is_measured, is_measured), "{}", peer.name());
        assert!(cost.operations.is_none_or(|n| Some(n) >= plain.operations), "{}", peer.name());
    }
}
