use super::*;

#[test]
fn resolves_missing_parts_as_folders() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = fs::canonicalize(folder.path()).expect("a folder");
    fs::create_dir(folder.join("assets")).expect("a folder");
    for (path, leads_to) in [
        ("assets", "assets"),
        ("assets/../assets/./", "assets"),
        ("build/../assets", "assets"),
        ("build/x/../../assets/new", "assets/new"),
        ("assets/new/../../build", "build"),
    ] {
        assert_eq!(real(&folder.join(path)).expect("a path"), folder.join(leads_to), "{path}");
    }
    assert_eq!(real(Path::new("no-such-folder/..")).ok(), fs::canonicalize(".").ok());
}

#[cfg(unix)]
#[test]
fn follows_links_to_existing_and_missing_targets() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().expect("a folder");
    let folder = fs::canonicalize(folder.path()).expect("a folder");
    fs::create_dir_all(folder.join("a/b")).expect("a folder");
    symlink("a/b", folder.join("there")).expect("a link");
    symlink("a/c", folder.join("missing")).expect("a link");
    symlink("loop", folder.join("loop")).expect("a link");
    assert_eq!(real(&folder.join("there/../x")).expect("a path"), folder.join("a/x"));
    assert_eq!(real(&folder.join("new/../missing/x")).expect("a path"), folder.join("a/c/x"));
    assert!(real(&folder.join("loop/x")).is_err());
}
