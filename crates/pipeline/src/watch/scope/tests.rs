use super::*;

#[cfg(unix)]
#[test]
fn files_that_are_read_matter_and_outputs_do_not() {
    let none = Path::new("/no-such-folder");
    let path = |name: &str| none.join(name);
    let files = [path("work/shared/wood.png"), path("work/assets/a.png")];
    let files = files.iter().map(PathBuf::as_path);
    let scope = Scope::new(&path("work/assets"), &[&path("work/assets/out"), &path("work/out")], files);
    for (name, concerns) in [
        ("work/assets", true),
        ("work/assets/new/b.gltf", true),
        ("work/assets/out/a.gltf", false),
        ("work/assets/out", false),
        ("work/out/a.gltf", false),
        ("work/other.png", false),
        ("work/shared/wood.png", true),
        ("work/shared/stone.png", false),
        ("work/shared", true),
        ("work", true),
        ("work/roughcast.toml", true),
        ("roughcast.toml", true),
        ("work/shared/roughcast.toml", false),
    ] {
        assert_eq!(scope.concerns(&path(name)), concerns, "{name}");
    }
    let folders = scope.folders();
    for name in ["", "work", "work/shared"] {
        assert!(folders.contains(&path(name)), "{name}");
    }
    assert!(folders.iter().all(|folder| !folder.starts_with(path("work/assets"))), "{folders:?}");
}
