use tempfile::{TempDir, tempdir};

use super::*;

fn written(folder: &TempDir, name: &str) -> Written {
    let path = folder.path().join(name);
    fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
    fs::write(&path, name).expect("a file");
    Written { source: path.clone(), path, blake3: crate::digest::digest(name.as_bytes()) }
}

fn names(folder: &TempDir, removed: &[Removed]) -> Vec<String> {
    let name = |removed: &Removed| removed.path.strip_prefix(folder.path()).expect("below").display().to_string();
    removed.iter().map(name).collect()
}

#[test]
fn removes_outputs_with_their_last_owner() {
    let folder = tempdir().expect("a folder");
    let (a, b) = (Path::new("a.gltf"), Path::new("b.gltf"));
    let [own, shared, other] = ["a/a.bin", "t/s.png", "b.bin"].map(|name| written(&folder, name));
    // Another path of the shared file.
    let again = Written { path: folder.path().join("a/../t/s.png"), ..shared.clone() };
    let mut ledger = Ledger::default();
    ledger.set(a, folder.path(), &[own.clone(), again]);
    ledger.set(b, folder.path(), &[shared.clone(), other.clone()]);
    ledger.set(a, folder.path(), &[]);
    assert_eq!(names(&folder, &ledger.sweep()), ["a/a.bin"]);
    assert!(!folder.path().join("a").exists() && shared.path.exists());
    ledger.set(b, folder.path(), &[other]);
    assert_eq!(names(&folder, &ledger.sweep()), ["t/s.png"]);
    ledger.set(b, folder.path(), &[]);
    assert_eq!(names(&folder, &ledger.sweep()), ["b.bin"]);
    assert!(folder.path().exists(), "the output folder itself");
}

#[test]
fn keeps_files_that_someone_else_wrote() {
    let folder = tempdir().expect("a folder");
    let [edited, kept] = ["x/edited.png", "x/kept.png"].map(|name| written(&folder, name));
    let mut ledger = Ledger::default();
    ledger.set(Path::new("a.gltf"), folder.path(), &[edited.clone(), kept.clone()]);
    fs::write(&edited.path, "by hand").expect("a file");
    fs::write(folder.path().join("x/foreign.txt"), "").expect("a file");
    ledger.set(Path::new("a.gltf"), folder.path(), &[]);
    assert_eq!(names(&folder, &ledger.sweep()), ["x/kept.png"]);
    assert!(edited.path.exists() && folder.path().join("x/foreign.txt").exists());
}

#[test]
fn keeps_an_output_that_moves_to_another_asset() {
    let folder = tempdir().expect("a folder");
    let file = written(&folder, "s.png");
    let mut ledger = Ledger::default();
    ledger.set(Path::new("a.gltf"), folder.path(), std::slice::from_ref(&file));
    ledger.set(Path::new("a.gltf"), folder.path(), &[]);
    ledger.set(Path::new("b.gltf"), folder.path(), std::slice::from_ref(&file));
    assert_eq!(ledger.sweep(), []);
    assert!(file.path.exists());
}
