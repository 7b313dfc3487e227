//! An attack by a disk that becomes full while outputs are written.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use tempfile::tempdir;
use walkdir::WalkDir;

use super::skip::missing_tool;

/// Runs `script` in its own mount namespace, so that its mounts are invisible to other processes and end with the
/// script.
fn in_private_mounts(folder: &Path, script: &str) -> Output {
    let unshare = ["--mount", "--user", "--map-root-user", "sh", "-c", script, env!("CARGO_BIN_EXE_roughcast")];
    Command::new("unshare").current_dir(folder).args(unshare).output().expect("util-linux has unshare")
}

fn hashes(folder: &Path) -> BTreeMap<String, String> {
    let files = WalkDir::new(folder).into_iter().map(|entry| entry.expect("an entry"));
    let files = files.filter(|entry| entry.file_type().is_file());
    let hash = |path: &Path| blake3::hash(&fs::read(path).expect("a file")).to_hex().to_string();
    let name = |path: &Path| path.strip_prefix(folder).expect("a path below").to_string_lossy().into_owned();
    files.map(|entry| (name(entry.path()), hash(entry.path()))).collect()
}

#[test]
fn a_full_disk_leaves_whole_files_and_ends_with_code_4() {
    let folder = tempdir().expect("a folder");
    let folder = folder.path();
    if !in_private_mounts(folder, "mkdir -p t && mount -t tmpfs -o size=64k tmpfs t").status.success() {
        return missing_tool("a full disk needs namespaces for mounts: `unshare --mount --user --map-root-user`");
    }
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures");
    let bake = format!("\"$0\" bake {} -o t/out --model isotropic --quiet", fixtures.display());
    let clean = in_private_mounts(folder, &format!("{bake} && mv t/out wanted"));
    assert!(clean.status.success(), "{}", String::from_utf8_lossy(&clean.stderr));
    let wanted = hashes(&folder.join("wanted"));
    for size in [16, 64, 100, 150, 200, 250, 300] {
        let kept = folder.join(format!("kept{size}"));
        let script = format!(
            "mount -t tmpfs -o size={size}k tmpfs t && {bake}; code=$?; mkdir {0} && cp -r t/. {0}; exit $code",
            kept.display()
        );
        let run = in_private_mounts(folder, &script);
        let err = String::from_utf8_lossy(&run.stderr);
        assert_eq!(run.status.code(), Some(4), "{size} KiB: {err}");
        assert!(err.lines().all(|line| line.starts_with("error: ")), "{size} KiB: {err}");
        // The folder is empty if not even the first file fits.
        for (name, hash) in hashes(&kept) {
            let wanted = name.strip_prefix("out/").and_then(|name| wanted.get(name));
            assert_eq!(wanted, Some(&hash), "{size} KiB: {name} is incomplete");
        }
    }
}
