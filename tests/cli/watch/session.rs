//! A running `roughcast watch` and its events.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::Duration;

use serde_json::Value;

use crate::process::{Run, hashes, roughcast_in};

/// Longest time to wait for an event, which no machine needs.
const PATIENCE: Duration = Duration::from_secs(100);

static MARKS: AtomicU64 = AtomicU64::new(0);

/// A command that watches `assets` in a folder and bakes to `out`.
pub struct Session {
    child: Child,
    events: Receiver<Value>,
    /// Files of the last good bake of each asset, without files that were reported as removed.
    baked: BTreeMap<String, BTreeSet<String>>,
}

impl Session {
    /// Starts the command with `options`.
    pub fn start(folder: &Path, options: &str) -> Self {
        Self::start_by(Command::new(env!("CARGO_BIN_EXE_roughcast")), folder, options)
    }

    /// Starts the command through another command that runs it.
    pub fn start_by(mut command: Command, folder: &Path, options: &str) -> Self {
        command.current_dir(folder).args("watch assets -o out --json".split(' ')).args(options.split_whitespace());
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("the command starts");
        let lines = BufReader::new(child.stdout.take().expect("a pipe")).lines();
        let (sender, events) = channel();
        thread::spawn(move || {
            for line in lines.map_while(Result::ok) {
                let event: Value =
                    serde_json::from_str(&line).unwrap_or_else(|_| panic!("expected JSON, found {line:?}"));
                if sender.send(event).is_err() {
                    break;
                }
            }
        });
        Self { child, events, baked: BTreeMap::new() }
    }

    /// Returns the next event, which satisfies the schema.
    pub fn event(&mut self) -> Value {
        let Ok(event) = self.events.recv_timeout(PATIENCE) else {
            let _ = self.child.kill();
            let mut err = String::new();
            let _ = self.child.stderr.take().expect("a pipe").read_to_string(&mut err);
            panic!("expected an event, found none: {:?}, {err}", self.child.wait());
        };
        let schema: Value = serde_json::from_str(include_str!("../../../schemas/watch.schema.json")).expect("JSON");
        let schema = jsonschema::validator_for(&schema).expect("a schema");
        let errors: Vec<String> = schema.iter_errors(&event).map(|e| format!("{}: {e}", e.instance_path())).collect();
        assert!(errors.is_empty(), "{event}: {errors:#?}");
        self.note(&event);
        event
    }

    /// Records files that an event reports as written or removed.
    fn note(&mut self, event: &Value) {
        let Some(files) = event["files"].as_array() else { return };
        let files = files.iter().map(|file| file.as_str().expect("a path").to_owned()).collect();
        if event["event"] == "baked" {
            self.baked.insert(event["input"].as_str().expect("an input").to_owned(), files);
        } else {
            self.baked.values_mut().for_each(|known| known.retain(|file| !files.contains(file)));
        }
    }

    /// Asserts that `out` equals a bake of `assets` to a new folder, with the last good outputs of assets that cannot
    /// be baked.
    pub fn assert_as_baked(&self, folder: &Path, context: &str) {
        assert_as_baked_beside(folder, context, &self.baked);
    }

    /// Returns the events up to the next one of this kind, which is the last.
    pub fn until(&mut self, kind: &str) -> Vec<Value> {
        let mut events = vec![self.event()];
        while events.last().expect("an event")["event"] != kind {
            events.push(self.event());
        }
        events
    }

    /// Adds an asset beside `assets/..` and waits until it is baked and nothing is left to do, so that all earlier
    /// changes are processed. Returns the events of other assets as `<event> <input>`.
    pub fn settle(&mut self, folder: &Path) -> Vec<String> {
        // Each call adds another asset, because an equal one would not be baked. It is renamed into place, because a
        // busy machine may pause between two writes.
        let number = MARKS.fetch_add(1, Ordering::Relaxed);
        let beside = folder.join("mark");
        fs::write(&beside, format!(r#"{{"asset":{{"version":"2.0","generator":"{number}"}}}}"#)).expect("a file");
        fs::rename(beside, folder.join("assets/mark.gltf")).expect("a file");
        let mut reported = Vec::new();
        loop {
            for event in self.until("idle") {
                let kind = event["event"].as_str().expect("an event");
                if let Some(input) = event["input"].as_str() {
                    reported.push(format!("{kind} {input}"));
                }
            }
            if reported.iter().any(|event| event == "baked assets/mark.gltf") {
                reported.retain(|event| !event.ends_with("assets/mark.gltf"));
                return reported;
            }
        }
    }

    /// Sends a signal to the command, such as `-STOP`.
    #[cfg(unix)]
    pub fn signal(&self, signal: &str) {
        let status = Command::new("kill").args([signal, &self.child.id().to_string()]).status();
        assert!(status.expect("a signal").success());
    }

    /// Ends the command as Ctrl-C does.
    pub fn stop(mut self) -> Run {
        #[cfg(unix)]
        self.signal("-INT");
        #[cfg(not(unix))]
        self.child.kill().expect("a process");
        let status = self.child.wait().expect("an exit");
        let mut err = String::new();
        self.child.stderr.take().expect("a pipe").read_to_string(&mut err).expect("UTF-8");
        Run { code: status.code().unwrap_or(-1), out: String::new(), err }
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        // A failed test leaves no process running.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Asserts that `out` equals a bake of `assets` to a new folder.
pub fn assert_as_baked(folder: &Path, context: &str) {
    assert_as_baked_beside(folder, context, &BTreeMap::new());
}

/// Asserts that `out` holds that bake and the files in `kept` of assets that cannot be baked.
fn assert_as_baked_beside(folder: &Path, context: &str, kept: &BTreeMap<String, BTreeSet<String>>) {
    let clean = folder.join("clean");
    let run = roughcast_in(folder, "bake assets -o clean --json".split(' '));
    assert!(matches!(run.code, 0 | 1), "{context}: {}", run.err);
    let (mut expected, found) = (hashes(&clean), hashes(&folder.join("out")));
    let report: Value = serde_json::from_str(&run.out).expect("a report");
    let assets = report["assets"].as_array().expect("assets").iter();
    let failed = assets.filter(|asset| asset["status"] == "failed").filter_map(|asset| asset["input"].as_str());
    for file in failed.filter_map(|input| kept.get(input)).flatten() {
        let name = file.strip_prefix("out/").expect("an output").to_owned();
        // The bytes are those of an earlier bake.
        let bytes = found.get(&name).cloned().unwrap_or_default();
        expected.entry(name).or_insert(bytes);
    }
    let names = |all: &BTreeMap<String, String>| all.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&found), names(&expected), "{context}\n{}", run.err);
    assert_eq!(found, expected, "{context}");
    if clean.exists() {
        fs::remove_dir_all(clean).expect("a folder");
    }
}
