use std::fs;

use tempfile::tempdir;

use super::*;
use crate::project::resolve;

/// A file that changes between the look at it and the plan has not settled, so the plan must name it.
#[test]
fn a_document_that_changed_before_it_was_read_is_a_changed_file() {
    let folder = tempdir().expect("a folder");
    let path = folder.path().join("a.gltf");
    let input = Input { path: path.clone(), folder: folder.path().join("out"), stem: "a".to_owned() };
    let resolved = resolve(&[]).expect("the defaults");
    let plan = |text: &str| {
        fs::write(&path, text).expect("a file");
        Planned::new(&input, &resolved)
    };
    let first = plan(r#"{"asset":{"version":"2.0"}}"#);
    let paths = |looks: Looks| looks.into_iter().map(|(path, _)| path).collect::<Vec<_>>();
    assert_eq!(paths(first.changed_files(None)), [path.as_path()], "of an unknown asset every file has changed");
    let known = KnownAsset {
        output: input.folder.clone(),
        values: resolved.values.clone(),
        id: None,
        seen: first.seen.clone(),
        state: State::Done(Vec::new()),
    };
    assert_eq!(paths(first.changed_files(Some(&known))), [] as [PathBuf; 0]);
    let second = plan(r#"{"asset":{"version":"2.0","generator":"another"}}"#);
    assert_eq!(paths(second.changed_files(Some(&known))), [path.as_path()]);
}
