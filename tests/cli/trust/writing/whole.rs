//! Tests that files are written completely, with the permissions of the umask, and that temporary files are removed.

use std::process::Command;
use std::time::{Duration, SystemTime};

use super::*;
use crate::process::files;
use crate::skip::skip;

const DAY: Duration = Duration::from_secs(86_400);

#[test]
fn leftovers_of_a_killed_run_are_removed_wherever_a_run_writes() {
    let scene = scene();
    let folder = scene.path();
    fs::create_dir(folder.join("A/textures")).expect("a folder");
    fs::rename(folder.join("A/brushed_colour.png"), folder.join("A/textures/colour.png")).expect("a file");
    edit(folder, "brushed_colour.png", "textures/colour.png");
    done(folder, "bake A -o O -q --cache cache");
    let clean = hashes(folder);
    let blob = clean.keys().find(|name| name.starts_with("cache/blobs/")).expect("a blob");
    let blobs = Path::new(blob).parent().expect("a folder").to_str().expect("UTF-8");
    let now = SystemTime::now();
    for (number, date) in [now - DAY, now + DAY].into_iter().enumerate() {
        for name in ["O", "O/textures", "O/brushed.roughcast", "cache/jobs", blobs] {
            let path = folder.join(name).join(format!(".roughcast-{number}"));
            fs::write(&path, "half").expect("a file");
            fs::File::options().write(true).open(path).and_then(|file| file.set_modified(date)).expect("a file");
        }
    }
    done(folder, "bake A -o O -q --cache cache");
    assert_eq!(hashes(folder), clean);
    // A temporary file of a running bake stays.
    fs::write(folder.join("O/textures/.roughcast-new"), "half").expect("a file");
    done(folder, "bake A -o O -q --cache cache");
    assert!(folder.join("O/textures/.roughcast-new").exists());
}

#[cfg(unix)]
#[test]
fn files_have_the_permissions_of_the_umask() {
    use std::os::unix::fs::PermissionsExt;
    for (umask, mode) in [("077", 0o600), ("002", 0o664), ("022", 0o644)] {
        let scene = scene();
        let folder = scene.path();
        let script = format!(
            "umask {umask}; \"$0\" bake A -o out/O -q --cache out/cache --report out/r.json && \"$0\" init out && \
             \"$0\" map A/brushed_normal.png -o out/n.ktx2 -q && \"$0\" man out/man"
        );
        let command =
            Command::new("sh").args(["-c", &script, env!("CARGO_BIN_EXE_roughcast")]).current_dir(folder).output();
        let run = Run::from(command.expect("a shell"));
        assert_eq!(run.code, 0, "{}", run.err);
        let written = files(&folder.join("out"));
        assert!(written.len() > 20);
        for (name, path) in written {
            let found = fs::metadata(path).expect("facts").permissions().mode() & 0o777;
            assert_eq!(found, mode, "{name} with umask {umask}: {found:o}");
        }
    }
}

/// The third file exceeds the limit, or the path of the document is taken.
#[cfg(unix)]
#[test]
fn an_asset_that_cannot_be_written_leaves_nothing_behind() {
    let scene = scene();
    let folder = scene.path();
    let script = "trap '' XFSZ; ulimit -f 8; exec \"$0\" bake A -o O -q";
    let command = Command::new("sh").args(["-c", script, env!("CARGO_BIN_EXE_roughcast")]).current_dir(folder).output();
    let run = Run::from(command.expect("a shell"));
    assert!(run.code != 0 && run.err.contains("expected to write O/"), "{}", run.err);
    assert!(!folder.join("O").exists(), "{:?}", hashes(&folder.join("O")));
    fs::create_dir_all(folder.join("O/brushed.gltf")).expect("a folder");
    refused(folder, "bake A -o O -q", 1, &["expected to write O/brushed.gltf"]);
    assert_eq!(hashes(&folder.join("O")).len(), 0);
    assert!(!folder.join("O/brushed.roughcast").exists());
}

/// A name that was not synced is lost after a power failure, even if its file was synced.
#[cfg(target_os = "linux")]
#[test]
fn names_are_synced_before_and_after_the_document_is_renamed() {
    let scene = scene();
    let folder = scene.path();
    let command = Command::new("strace")
        .args(["-f", "-y", "-e", "trace=fsync,rename,renameat,renameat2", "-o", "trace"])
        .arg(env!("CARGO_BIN_EXE_roughcast"))
        .args("bake A -o O -q".split(' '))
        .current_dir(folder)
        .output();
    match command {
        Ok(output) if output.status.success() => {}
        _ => {
            return skip("syncing folders needs strace and the right to trace");
        }
    }
    let trace = fs::read_to_string(folder.join("trace")).expect("a trace");
    let lines: Vec<&str> = trace.lines().collect();
    let at = |what: &str, end: &str| {
        lines
            .iter()
            .rposition(|line| line.contains(what) && line.contains(end))
            .unwrap_or_else(|| panic!("{what} {end}: {trace}"))
    };
    let (texture, document) = (at("rename", ".ktx2\""), at("rename", "brushed.gltf\""));
    let (textures, output) = (at("fsync", "/O/brushed.roughcast>"), at("fsync", "/O>"));
    assert!(texture < textures && textures < document && document < output, "{trace}");
}
