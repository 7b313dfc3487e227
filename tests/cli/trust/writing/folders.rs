//! Output folders that lead to sources or elsewhere through `..` or links.

use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};
use std::sync::mpsc::channel;
use std::thread;
use std::time::Duration;

use super::*;

const APART: &str = "expected an output folder apart from the inputs";

#[test]
fn a_path_through_a_missing_folder_is_resolved() {
    let scene = scene();
    let folder = scene.path();
    for output in ["build/../A", "x/y/../../A", "A/../build/../A/.", "A/new/.."] {
        for command in ["bake", "bake --cache cache", "plan"] {
            let options = if command == "plan" { "" } else { "-q" };
            let inputs = command.replacen("bake", "bake A", 1).replacen("plan", "plan A", 1);
            refused(folder, &format!("{inputs} -o {output} {options}"), 1, &[APART]);
        }
    }
    fs::write(folder.join("A/roughcast.toml"), "output = '../build/../A'\n").expect("a file");
    refused(folder, "bake A -q", 1, &[APART]);
    fs::remove_file(folder.join("A/roughcast.toml")).expect("a file");
    assert!(!folder.join("build").exists());
    // Paths that lead to other folders work.
    done(folder, "bake A -o build/../O -q");
    assert!(folder.join("O/brushed.gltf").is_file());
}

#[test]
fn a_plan_that_writes_to_the_sources_is_not_run() {
    let scene = scene();
    let folder = scene.path();
    let plan = done(folder, "plan A -o out --json");
    for output in ["build/../A", "A"] {
        fs::write(folder.join("p.json"), plan.replace("\"output\": \"out\"", &format!("\"output\": \"{output}\"")))
            .expect("a file");
        let before = hashes(&folder.join("A"));
        let run = run(folder, "bake --plan p.json -q");
        assert!(run.code != 0 && hashes(&folder.join("A")) == before, "{output}: {}", run.err);
    }
}

#[test]
fn watch_does_not_bake_over_the_sources() {
    let scene = scene();
    let folder = scene.path();
    let before = hashes(&folder.join("A"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_roughcast"));
    command.current_dir(folder).args("watch A -o build/../A -q".split(' '));
    let mut child =
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the command starts");
    let mut lines = BufReader::new(child.stderr.take().expect("a pipe")).lines();
    let (sender, first_line) = channel();
    thread::spawn(move || sender.send(lines.next()));
    let line = first_line.recv_timeout(Duration::from_secs(100));
    child.kill().expect("a process");
    child.wait().expect("an end");
    assert_eq!(hashes(&folder.join("A")), before, "a source changed");
    let line = line.expect("a complaint").expect("a line").expect("UTF-8");
    assert!(line.contains(APART), "{line}");
}

#[cfg(unix)]
#[test]
fn links_that_lead_out_of_the_output_folder_are_not_followed() {
    use std::os::unix::fs::symlink;
    for (link, target, line) in [
        ("O/brushed.roughcast", "../A", "bake A -o O -q"),
        ("O/brushed.roughcast", "../away", "bake A -o O -q"),
        ("O/brushed.roughcast", "../not-there", "bake A -o O -q"),
        ("O/A", "../away", "bake . -o O -q"),
        ("O/brushed.roughcast", "../away", "bake A -o O -q --cache cache"),
    ] {
        let scene = scene();
        let folder = scene.path();
        fs::create_dir(folder.join("away")).expect("a folder");
        fs::create_dir(folder.join("O")).expect("a folder");
        if line.contains("--cache") {
            done(folder, "bake A -o warm -q --cache cache");
        }
        symlink(target, folder.join(link)).expect("a link");
        let says = format!("found that {link} is a link to ");
        refused(folder, line, 1, &["brushed.gltf: expected to write ", &says, "remove the link"]);
        assert_eq!(hashes(&folder.join("away")).len(), 0, "{link}");
        assert!(!folder.join("not-there").exists());
    }
}

#[cfg(unix)]
#[test]
fn links_within_and_to_the_output_folder_work() {
    use std::os::unix::fs::symlink;
    let scene = scene();
    let folder = scene.path();
    fs::create_dir_all(folder.join("disk/textures")).expect("a folder");
    symlink("disk", folder.join("O")).expect("a link");
    symlink("textures", folder.join("disk/brushed.roughcast")).expect("a link");
    done(folder, "bake A -o O -q");
    assert!(folder.join("disk/brushed.gltf").is_file() && hashes(&folder.join("disk/textures")).len() > 2);
}

/// A bake does not write to a folder of the cache that is a link to another folder.
#[cfg(unix)]
#[test]
fn a_cache_is_not_written_to_through_links() {
    use std::os::unix::fs::symlink;
    let scene = scene();
    let folder = scene.path();
    fs::create_dir(folder.join("cache")).expect("a folder");
    fs::create_dir(folder.join("away")).expect("a folder");
    symlink("../away", folder.join("cache/blobs")).expect("a link");
    let run = run(folder, "bake A -o O -q --cache cache");
    assert_eq!(run.code, 0, "{}", run.err);
    assert!(run.err.contains("warning: ") && run.err.contains("remove the link"), "{}", run.err);
    assert_eq!(hashes(&folder.join("away")).len(), 0);
}
