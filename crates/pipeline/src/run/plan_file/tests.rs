use std::fs;

use super::*;

#[test]
fn rejects_plans_of_another_format_and_of_another_version() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("plan.json");
    let read = |text: &str| {
        fs::write(&path, text).expect("a file");
        Plan::read(&path)
    };
    let plan = Plan::new(Vec::new());
    assert_eq!(read(&serde_json::to_string(&plan).expect("JSON")).expect("a plan"), plan);
    let other = Plan { format_version: 2, ..plan.clone() };
    let error = read(&serde_json::to_string(&other).expect("JSON")).expect_err("another format").to_string();
    assert!(error.contains("expected a plan of formatVersion 1, found 2; plan again"), "{error}");
    let other = Plan { version: "0.0.0".to_owned(), ..plan };
    assert!(matches!(read(&serde_json::to_string(&other).expect("JSON")), Err(PlanError::OtherVersion { .. })));
    let other = r#"{ "formatVersion": 1, "version": "0.0.0", "jobs": [{ "a-later-member": 1 }] }"#;
    assert!(matches!(read(other), Err(PlanError::OtherVersion { .. })));
    assert!(matches!(read("{}"), Err(PlanError::Format { .. })));
    assert!(matches!(read("no JSON"), Err(PlanError::Malformed { .. })));
}
