//! Compares help, summaries and messages with the transcripts in `tests/cmd`. `SNAPSHOTS=overwrite` writes them anew.

use std::fs;
use std::path::Path;

use snapbox::{Assert, Data, Redactions};
use tempfile::tempdir;

use super::process::{copy, fixtures, roughcast_in};

/// Runs each command line in a copy of the fixtures. Compares output and exit codes with `tests/cmd/<name>.txt`, in
/// which `SECONDS` stands for times.
fn transcript(name: &str, command_lines: &[&str]) {
    let folder = tempdir().expect("a folder");
    copy(&fixtures(), folder.path());
    fs::create_dir(folder.path().join("empty")).expect("a folder");
    let mut text = String::new();
    for line in command_lines {
        let run = roughcast_in(folder.path(), line.split_whitespace().skip(1));
        text += &format!("$ {line}\n{}{}", without_seconds(&run.out), run.err);
        if run.code != 0 {
            text += &format!("exit code {}\n", run.code);
        }
        text += "\n";
    }
    let text: String = text.lines().map(|line| format!("{}\n", line.trim_end())).collect();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/cmd/{name}.txt"));
    let mut redactions = Redactions::new();
    redactions.insert("[VERSION]", env!("CARGO_PKG_VERSION")).expect("a placeholder");
    redactions.insert("[EXE]", std::env::consts::EXE_SUFFIX).expect("a placeholder");
    Assert::new().action_env("SNAPSHOTS").redact_with(redactions).eq(text, Data::read_from(&path, None));
}

/// Replaces times at the ends of lines, such as `0.06 s`, by `SECONDS`.
fn without_seconds(text: &str) -> String {
    let line = |line: &str| match line.strip_suffix(" s").and_then(|l| l.rsplit_once(", ")) {
        Some((rest, seconds)) if seconds.parse::<f64>().is_ok() => format!("{rest}, SECONDS\n"),
        _ => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}

#[test]
fn help() {
    transcript("help", &["roughcast", "roughcast --help", "roughcast --version"]);
}

#[test]
fn help_of_each_command() {
    for command in ["bake", "init", "map", "watch", "check", "compare", "plan", "render", "view", "completions", "man"]
    {
        transcript(&format!("help_{command}"), &[&format!("roughcast {command} --help")]);
    }
    transcript("help_plan_merge", &["roughcast plan merge --help"]);
}

#[test]
fn bake() {
    transcript(
        "bake",
        &[
            "roughcast bake brushed waves -o out",
            "roughcast bake knobs/knobs.gltf -o out --engine bevy -v",
            "roughcast bake heights -o out --profile pyramid --model isotropic",
            "roughcast bake knobs -o out --quiet",
            "roughcast bake brushed knobs -o out --nearest 400 --screen-height 1080 --trim",
        ],
    );
}

#[test]
fn map() {
    transcript(
        "map",
        &[
            "roughcast map maps/vgroove_normal.png -o out/grooves.ktx2 --roughness-factor 0.3",
            "roughcast map maps/dunes_height.exr -o out/dunes.ktx2 --height --height-scale 0.02 --profile pyramid",
            "roughcast map maps/line_normal.png -o out/line.ktx2 --json --target float",
            "roughcast map maps/two_channel_normal.png -o out/pimples.ktx2 --quiet",
        ],
    );
}

#[test]
fn usage_errors() {
    transcript(
        "usage",
        &[
            "roughcast bake",
            "roughcast bake brushed",
            "roughcast bake brushed -o out --max-error 2",
            "roughcast bake brushed -o out --rdo 0",
            "roughcast bake brushed -o out --rdo 6.5",
            "roughcast bake brushed -o out --target etc1s",
            "roughcast bake brushed -o out --main-direction 0,0,0",
            "roughcast bake brushed -o out --glb --gltf dual",
            "roughcast bake brushed -o out --quiet --json",
            "roughcast bake brushed -o out --trim",
            "roughcast bake brushed -o out --nearest 2",
            "roughcast bake brushed -o out --nearest -2 --screen-height 1080",
            "roughcast bake brushed -o out --nearest 2 --screen-height 0",
            "roughcast bake brushed -o out --nearest 2 --screen-height 1080 --fov 180",
            "roughcast map maps/line_normal.png -o out.ktx2 --wrap round",
            "roughcast render brushed/brushed.gltf",
            "roughcast render -o out --distance 1,0",
            "roughcast render -o out --scene moon",
            "roughcast render -o out --width 0",
            "roughcast frobnicate",
        ],
    );
}

#[test]
fn errors() {
    transcript(
        "errors",
        &[
            "roughcast bake brushed -o brushed",
            "roughcast bake empty -o out",
            "roughcast bake missing.gltf -o out",
            "roughcast bake maps/line_normal.png -o out",
            "roughcast bake brushed -o out --max-texels 1000",
            "roughcast bake brushed -o brushed/brushed.bin",
            "roughcast map missing.png -o out.ktx2",
            "roughcast map maps/line_normal.png -o maps/line_normal.png",
            "roughcast map heights/heights.png -o out.ktx2",
            "roughcast map maps/dunes_height.exr -o out.ktx2 --height --layer Z",
            "roughcast map brushed/brushed.bin -o out.ktx2",
            "roughcast render missing.png -o out",
            "roughcast render brushed/brushed.bin -o out",
            "roughcast render heights/heights.png -o out",
            "roughcast render brushed/brushed.gltf -o brushed/brushed.bin --scene highlight --width 8",
        ],
    );
}
