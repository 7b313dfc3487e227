//! Charts and tables of made-up numbers.

use super::{Comparison, Cost, Entry, Kind, chart, csv};

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
fn every_entry_is_a_row_and_names_are_quoted() {
    let text = csv(&[comparison("a,\"b\"")]);
    assert_eq!(text.lines().count(), 19);
    assert!(text.lines().skip(1).all(|line| line.starts_with("\"a,\"\"b\"\"\",model ")), "{text}");
    let columns = |line: &str| line.replace("\"a,\"\"b\"\"\"", "").matches(',').count();
    assert!(text.lines().all(|line| columns(line) == 11), "{text}");
}

#[test]
fn every_entry_is_labelled_and_hostile_names_are_text() {
    let svg = chart(&comparison("<script>&\u{1}"));
    assert!(svg.contains("&lt;script&gt;&amp;\u{fffd}") && !svg.contains("<script"));
    for i in 0..17 {
        assert_eq!(svg.matches(&format!(">model {i}<")).count() + svg.matches(&format!(">model {i} (c")).count(), 2);
    }
    assert_eq!(svg.matches("class=\"ring\"").count(), 1);
}

#[test]
fn without_any_numbers_there_is_still_a_chart() {
    let svg = chart(&Comparison { material: String::new(), entries: Vec::new() });
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
}
