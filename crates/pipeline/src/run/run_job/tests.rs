use super::*;

#[test]
fn reports_the_first_changed_file_by_name() {
    let paths = ["b.png", "a.png", "c.png"];
    let input = |path: &&str| JobInput { path: path.into(), blake3: Some(digest(b"a file that is gone")), bytes: 1 };
    let planned: Vec<JobInput> = paths.iter().map(input).collect();
    let planned = planned.iter().map(|input| (input.path.as_path(), input)).collect();
    let inputs = Inputs { source: Path::new("asset.gltf"), planned, changed: Mutex::new(None) };
    for path in paths {
        assert!(inputs.read(Path::new(path)).is_err());
    }
    assert_eq!(inputs.changed(), Some("a.png".into()));
}

#[test]
fn compares_digests_that_the_reader_computed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    std::fs::write(&path, "as planned").unwrap();
    let planned = JobInput { path: path.clone(), blake3: Some(digest(b"as planned")), bytes: 10 };
    let source = folder.path().join("asset.gltf");
    let inputs = || Inputs { source: &source, planned: [(path.as_path(), &planned)].into(), changed: Mutex::new(None) };
    for (hashed, changed) in [(&b"as planned"[..], None), (b"another", Some(path.clone()))] {
        let inputs = inputs();
        assert_eq!(inputs.read_to_hash(Path::new("a.png")).unwrap(), b"as planned");
        assert_eq!(inputs.changed(), None);
        inputs.hashed(Path::new("a.png"), digest(hashed));
        assert_eq!(inputs.changed(), changed);
    }
}

/// Returns a folder with a copy of the fixture `brushed`, and the job of its bake.
fn brushed() -> (tempfile::TempDir, Job) {
    let folder = tempfile::tempdir().unwrap();
    for file in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/brushed")).unwrap() {
        let file = file.unwrap();
        std::fs::copy(file.path(), folder.path().join(file.file_name())).unwrap();
    }
    let source = folder.path().join("brushed.gltf");
    let job = Job::new(&source, &folder.path().join("baked"), None, &crate::project::Values::default()).unwrap();
    (folder, job)
}

/// A watched folder may go and return during a bake. An error that another try would not have must say so.
#[test]
fn a_source_that_is_gone_when_outputs_are_written_has_changed() {
    let (_folder, job) = brushed();
    let prepared = || prepare(&job, None, &MemoryBudget::new(1), &|_| ());
    let finish = |prepared| finish(&job, prepared, &mut Guard::default(), &mut |_| ());
    assert!(finish(prepared()).is_ok());
    let again = prepared();
    std::fs::remove_file(&job.source).unwrap();
    let error = finish(again).err();
    assert!(matches!(&error, Some(RunError::Changed { path }) if *path == job.source), "{error:?}");
}

#[test]
fn reports_files_that_change_after_planning() {
    let (_folder, job) = brushed();
    let bake = || {
        let prepared = prepare(&job, None, &MemoryBudget::new(1), &|_| ());
        finish(&job, prepared, &mut Guard::default(), &mut |_| ())
    };
    assert!(bake().is_ok());
    assert_eq!(job.inputs.len(), 5);
    for input in &job.inputs {
        let path = &input.path;
        let planned = std::fs::read(path).unwrap();
        std::fs::write(path, [&planned[..], b"\n"].concat()).unwrap();
        let error = bake().err();
        assert!(matches!(&error, Some(RunError::Changed { path: changed }) if changed == path), "{path:?}: {error:?}");
        std::fs::write(path, planned).unwrap();
    }
}
