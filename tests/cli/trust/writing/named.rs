//! Files that the user names: reports, depfiles, plans, pictures, maps, configurations and pages.

use std::process::Command;

use super::*;

#[test]
fn reports_and_depfiles_replace_no_source_and_no_output() {
    let scene = scene();
    let folder = scene.path();
    fs::write(folder.join("A/roughcast.toml"), "").expect("a file");
    for option in ["--report", "--depfile"] {
        for source in ["A/brushed.gltf", "A/brushed.bin", "x/../A/brushed_normal.png", "A/roughcast.toml"] {
            let line = format!("bake A -o O -q {option} {source}");
            refused(folder, &line, 2, &["expected a file of its own, found that it is a source of this run"]);
        }
        for output in ["O/brushed.gltf", "O/brushed.bin", "O/brushed.roughcast/any.ktx2"] {
            let line = format!("bake A -o O -q {option} {output}");
            refused(folder, &line, 2, &["expected a file of its own, found that it is an output of this run"]);
        }
    }
    refused(folder, "bake A -o O -q --report one --depfile ./one", 2, &["it is an output of this run"]);
    assert!(!folder.join("O").exists(), "something was done");
    done(folder, "bake A -o O -q --report O/report.json --depfile O/brushed.d");
    assert!(folder.join("O/report.json").is_file() && folder.join("O/brushed.d").is_file());
    fs::write(folder.join("plan.json"), done(folder, "plan A -o O --json")).expect("a file");
    refused(folder, "bake --plan plan.json -q --report plan.json", 2, &["it is a source of this run"]);
}

#[cfg(unix)]
#[test]
fn a_report_replaces_no_pipe_and_no_file_that_a_link_names() {
    let scene = scene();
    let folder = scene.path();
    let made = Command::new("mkfifo").arg(folder.join("pipe")).status().expect("a command");
    assert!(made.success());
    refused(folder, "bake A -o O -q --report pipe", 2, &["expected a file or nothing at pipe"]);
    std::os::unix::fs::symlink("A", folder.join("link")).expect("a link");
    refused(folder, "bake A -o O -q --report link/brushed.gltf", 2, &["it is a source of this run"]);
    std::os::unix::fs::symlink("A/brushed.gltf", folder.join("r.json")).expect("a link");
    refused(folder, "bake A -o O -q --report r.json", 0, &[]);
    assert!(!folder.join("r.json").is_symlink(), "the link is replaced");
}

#[test]
fn the_rest_of_a_plan_replaces_nothing_that_the_plan_is_about() {
    let scene = scene();
    let folder = scene.path();
    fs::write(folder.join("plan.json"), done(folder, "plan A -o O --json")).expect("a file");
    done(folder, "bake --plan plan.json -q --report r.json");
    let before = hashes(folder);
    for rest in ["plan.json", "r.json", "A/brushed.gltf", "A/brushed.bin", "O/brushed.gltf", "O/brushed.roughcast/x"] {
        let line = format!("plan merge plan.json r.json --rest {rest}");
        refused(folder, &line, 2, &["expected a file of its own"]);
    }
    assert_eq!(hashes(folder), before);
    done(folder, "plan merge plan.json r.json --rest rest.json");
}

/// Outputs must not replace any file of the asset, not only its document.
#[test]
fn pictures_and_charts_replace_no_file_of_the_asset() {
    let scene = scene();
    let folder = scene.path();
    fs::rename(folder.join("A/brushed_colour.png"), folder.join("A/highlight.png")).expect("a file");
    fs::rename(folder.join("A/brushed.bin"), folder.join("A/compare.csv")).expect("a file");
    edit(folder, "brushed_colour.png", "highlight.png");
    edit(folder, "brushed.bin", "compare.csv");
    let line = "render A/brushed.gltf -o A --scene highlight --width 8 -q";
    let before = hashes(&folder.join("A"));
    let drawn = run(folder, line);
    assert!(drawn.code == 1 && drawn.err.contains("it is a source of this run"), "{}", drawn.err);
    let after = hashes(&folder.join("A"));
    assert!(before.iter().all(|(name, hash)| after.get(name) == Some(hash)), "a source changed");
    refused(folder, "compare A/brushed.gltf -o A --texels 1 -q", 1, &["compare.csv: ", "a source of this run"]);
}

#[test]
fn levels_replace_no_buffer_of_the_document() {
    let scene = scene();
    let folder = scene.path();
    done(folder, "bake A -o O -q");
    let written = done(folder, "inspect O/brushed.gltf --extract levels");
    let level = written.lines().find_map(|line| line.strip_prefix("wrote levels/")).expect("a level").to_owned();
    fs::rename(folder.join("O/brushed.bin"), folder.join("O").join(&level)).expect("a file");
    let document = folder.join("O/brushed.gltf");
    let text = fs::read_to_string(&document).expect("a document").replace("brushed.bin", &level.replace(' ', "%20"));
    fs::write(&document, text).expect("a file");
    let before = hashes(&folder.join("O"));
    refused(folder, "inspect O/brushed.gltf --extract O", 1, &[&level, "a source of this run"]);
    assert_eq!(hashes(&folder.join("O")), before);
}

#[test]
fn a_map_is_written_to_ktx2_files_only_and_not_over_its_sources() {
    let scene = scene();
    let folder = scene.path();
    let source = ["it is a source of this run"];
    refused(folder, "map A/brushed_normal.png -o A/brushed_normal.png", 1, &source);
    refused(folder, "map A/brushed_normal.png -o x.png", 2, &["-o x.png: ", ".ktx2 file", "name it x.ktx2"]);
    refused(folder, "map A/brushed_normal.png -o x", 2, &["name it x.ktx2"]);
    done(folder, "map A/brushed_normal.png -o A/n.ktx2 --quiet");
    refused(folder, "map A/n.ktx2 -o y/../A/n.ktx2", 1, &source);
    refused(folder, "map A/brushed_normal.png --roughness A/n.ktx2 -o A/n.ktx2", 1, &source);
    assert!(!folder.join("x.png").exists() && !folder.join("x").exists());
}

/// `init` never replaces a file, and no command leaves a part of one. `ulimit -f 0` makes every write fail.
#[cfg(unix)]
#[test]
fn configurations_and_pages_are_written_whole_or_not_at_all() {
    let scene = scene();
    let folder = scene.path();
    let limited = |line: &str| -> Run {
        let script = format!("trap '' XFSZ; ulimit -f 0; exec \"$0\" {line}");
        let command =
            Command::new("sh").args(["-c", &script, env!("CARGO_BIN_EXE_roughcast")]).current_dir(folder).output();
        command.expect("a shell").into()
    };
    let run = limited("init A");
    assert!(run.code == 1 && run.err.contains("A/roughcast.toml: expected to write a new file"), "{}", run.err);
    done(folder, "man pages");
    let before = hashes(folder);
    assert!(before.keys().filter(|name| name.starts_with("pages/roughcast")).count() > 11);
    let run = limited("man pages");
    assert!(run.code == 1 && run.err.contains("expected to write pages/roughcast"), "{}", run.err);
    let run = limited("man more");
    assert!(run.code == 1 && run.err.contains("expected to write more/roughcast"), "{}", run.err);
    assert_eq!(hashes(folder), before);
    fs::write(folder.join("A/roughcast.toml"), "mine").expect("a file");
    refused(folder, "init A", 1, &["expected to write a new file"]);
}
