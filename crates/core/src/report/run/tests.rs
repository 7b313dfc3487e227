use super::*;
use crate::settings::{Model, Settings};

#[test]
fn reads_back_what_it_writes() {
    let failed = AssetOutcome::failed("a.gltf".to_owned(), None, 1.0, "expected a file".to_owned(), true);
    let settings = RecordedSettings::new(&Settings::default(), Model::Auto);
    let report = RunReport::new(settings, vec![failed], Vec::new(), None);
    let part = PartReport::parse(&serde_json::to_vec(&report).expect("JSON")).expect("a report");
    assert_eq!((part.assets.len(), part.assets[0].input.as_str(), part.assets[0].retry), (1, "a.gltf", true));
}

#[test]
fn rejects_reports_of_another_format() {
    let error = PartReport::parse(br#"{"formatVersion":2,"assets":[]}"#).expect_err("another format");
    assert!(matches!(error, ReportError::Format(FormatError { expected: REPORT_FORMAT, found: Some(2), .. })));
    assert!(matches!(PartReport::parse(b"1"), Err(ReportError::Malformed(_))));
}
