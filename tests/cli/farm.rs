//! Runs the command lines of the examples for schedulers as a scheduler would run them.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::{Value, json};
use tempfile::{TempDir, tempdir};

use super::process::{Run, copy, fixtures, hashes, roughcast_in};

const DONE: &str = "2 jobs: 2 done, 0 failed, 0 missing\n";

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/farm").join(name)
}

fn yaml(name: &str) -> Value {
    serde_saphyr::from_str(&fs::read_to_string(example(name)).expect("an example")).expect("YAML")
}

/// Writes two assets and the folder of reports.
fn scene() -> TempDir {
    let folder = tempdir().expect("a folder");
    for asset in ["brushed", "heights"] {
        copy(&fixtures().join(asset), &folder.path().join("assets").join(asset));
    }
    fs::create_dir(folder.path().join("reports")).expect("a folder");
    folder
}

/// Runs `line` in the shell with the tool on its PATH.
fn shell(folder: &Path, line: &str, variables: &[(&str, &str)]) -> Run {
    let tool = Path::new(env!("CARGO_BIN_EXE_roughcast")).parent().expect("a folder").to_owned();
    let paths = env::var_os("PATH").unwrap_or_default();
    let paths = env::join_paths([tool].into_iter().chain(env::split_paths(&paths))).expect("paths");
    let mut command = Command::new("bash");
    command.args(["-euc", line]).current_dir(folder).env("PATH", paths).envs(variables.iter().copied());
    command.output().expect("bash").into()
}

fn done(folder: &Path, line: &str, variables: &[(&str, &str)]) -> String {
    let run = shell(folder, line, variables);
    assert_eq!((run.code, run.err.as_str()), (0, ""), "{line}");
    run.out
}

/// Returns the first command line in the comments of an example that begins with `start`.
fn command_line(name: &str, start: &str) -> String {
    let text = fs::read_to_string(example(name)).expect("an example");
    let mut lines = text.lines().filter_map(|line| line.strip_prefix("#   "));
    lines.find(|line| line.starts_with(start)).unwrap_or_else(|| panic!("{name} has no {start}")).to_owned()
}

/// Returns the outputs of a bake without a scheduler.
fn whole(folder: &Path) -> std::collections::BTreeMap<String, String> {
    let run = roughcast_in(folder, "bake assets -o whole -q".split(' '));
    assert_eq!((run.code, run.err.as_str()), (0, ""));
    hashes(&folder.join("whole"))
}

#[test]
fn slurm_example_runs_every_job() {
    let script = example("slurm.sh");
    let text = fs::read_to_string(&script).expect("an example");
    assert!(text.contains("\n#SBATCH --array=0-7\n") && text.contains(" --shard /8 "));
    let scene = scene();
    let folder = scene.path();
    done(folder, &command_line("slurm.sh", "roughcast plan assets"), &[]);
    let line = format!("bash {}", script.display());
    for task in 0..8 {
        let task = task.to_string();
        done(
            folder,
            &line,
            &[("SLURM_ARRAY_TASK_ID", &task), ("SLURM_ARRAY_TASK_MAX", "7"), ("SLURM_CPUS_PER_TASK", "1")],
        );
    }
    assert_eq!(done(folder, &command_line("slurm.sh", "roughcast plan merge"), &[]), DONE);
    assert_eq!(hashes(&folder.join("baked")), whole(folder));
    fs::write(folder.join("plan.json"), "{}").expect("a file");
    assert_eq!(shell(folder, &line, &[("SLURM_ARRAY_TASK_ID", "0")]).code, 2, "what cannot succeed is not tried again");
}

#[test]
fn kubernetes_example_runs_every_job() {
    let job = yaml("kubernetes.yaml");
    let spec = &job["spec"];
    let container = &spec["template"]["spec"]["containers"][0];
    assert_eq!((&job["apiVersion"], &job["kind"]), (&json!("batch/v1"), &json!("Job")));
    assert_eq!((&spec["completionMode"], &spec["completions"]), (&json!("Indexed"), &json!(8)));
    let on_exit_codes = &spec["podFailurePolicy"]["rules"][0]["onExitCodes"];
    assert_eq!((&on_exit_codes["containerName"], &on_exit_codes["values"]), (&container["name"], &json!([1, 2])));
    assert_eq!(spec["template"]["spec"]["restartPolicy"], "Never", "podFailurePolicy demands it");
    assert_eq!(spec["template"]["spec"]["volumes"][0]["name"], container["volumeMounts"][0]["name"]);
    let words: Vec<&str> = container["command"].as_array().expect("words").iter().filter_map(Value::as_str).collect();
    assert!(words.contains(&"--shard=/8"));
    let scene = scene();
    let folder = scene.path();
    done(folder, &command_line("kubernetes.yaml", "roughcast plan assets"), &[]);
    for index in 0..8 {
        let index = index.to_string();
        let line = words.join(" ").replace("$(JOB_COMPLETION_INDEX)", &index);
        done(folder, &line, &[("JOB_COMPLETION_INDEX", &index)]);
    }
    assert_eq!(done(folder, &command_line("kubernetes.yaml", "roughcast plan merge"), &[]), DONE);
    assert_eq!(hashes(&folder.join("baked")), whole(folder));
}

#[test]
fn github_example_runs_every_job() {
    let jobs = &yaml("github.yml")["jobs"];
    let line = |job: &str| -> String {
        let steps = jobs[job]["steps"].as_array().expect("steps").iter();
        steps.filter_map(|step| step["run"].as_str()).collect::<Vec<_>>().join("\n")
    };
    let parts = jobs["bake"]["strategy"]["matrix"]["part"].as_array().expect("parts");
    let scene = scene();
    let folder = scene.path();
    done(folder, &line("plan"), &[]);
    // Each part runs on a machine of its own. Artifacts are copied to the last one.
    let merging = tempdir().expect("a folder");
    fs::copy(folder.join("plan.json"), merging.path().join("plan.json")).expect("a file");
    for part in parts {
        let machine = tempdir().expect("a folder");
        copy(folder, machine.path());
        let part = part.to_string();
        done(machine.path(), &line("bake").replace("${{ matrix.part }}", &part), &[]);
        for artifact in
            ["baked", "reports"].map(|name| (machine.path().join(name), name)).iter().filter(|a| a.0.exists())
        {
            copy(&artifact.0, &merging.path().join(artifact.1));
        }
    }
    assert!(line("bake").contains(&format!("/{} ", parts.len())), "as many parts as the matrix has");
    assert_eq!(done(merging.path(), &line("merge"), &[]), DONE);
    assert_eq!(hashes(&merging.path().join("baked")), whole(folder));
}
