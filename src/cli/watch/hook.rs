//! `--on-change`.

use std::ffi::OsString;
use std::io;
use std::path::PathBuf;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use super::events::Changes;

/// Largest variable: Linux takes 128 KiB.
const MAX_BYTES: usize = 100_000;

/// How long a command that is asked to end may take to tidy up.
const GRACE: Duration = Duration::from_secs(2);

/// Pause between two looks at whether a command has ended.
const PAUSE: Duration = Duration::from_millis(5);

/// A command of the shell.
pub struct Hook {
    command: String,
    /// Standard output is ours alone.
    is_json: bool,
}

/// Why it did not do what it should have.
#[derive(Debug, thiserror::Error)]
pub enum HookError {
    /// There is no shell.
    #[error("expected to run {command:?}, found: {error}")]
    Start {
        /// The command.
        command: String,
        /// The system's error.
        error: io::Error,
    },
    /// It ended badly.
    #[error("expected {command:?} to end with exit code 0, found {status}")]
    Failed {
        /// The command.
        command: String,
        /// How it ended.
        status: ExitStatus,
    },
    /// A path that would be two lines.
    #[error(
        "{}: expected a path of one line, found a line break in it; {variable} leaves it out, --json lists it",
        path.display()
    )]
    LineBreak {
        /// The path.
        path: PathBuf,
        /// The variable that should have it.
        variable: &'static str,
    },
}

impl Hook {
    /// Of `--on-change`; with `--json` the command prints to standard error.
    pub fn new(command: &str, is_json: bool) -> Self {
        Self { command: command.to_owned(), is_json }
    }

    /// Runs it and waits for it; on `stop` ends it and all that it started. Returns what is to be complained of.
    pub fn run(&self, changes: &Changes, stop: &AtomicBool) -> Vec<HookError> {
        let (outputs, removed) =
            (lines("ROUGHCAST_OUTPUTS", &changes.outputs), lines("ROUGHCAST_REMOVED", &changes.removed));
        let ended = self.start(&[&outputs, &removed]).and_then(|child| wait(child, stop));
        let failed = match ended {
            Ok(Some(status)) if !status.success() => Some(HookError::Failed { command: self.command.clone(), status }),
            Ok(_) => None,
            Err(error) => Some(HookError::Start { command: self.command.clone(), error }),
        };
        outputs.left_out.into_iter().chain(removed.left_out).chain(failed).collect()
    }

    fn start(&self, variables: &[&Variable]) -> io::Result<Child> {
        let (shell, flag) = if cfg!(windows) { ("cmd", "/C") } else { ("sh", "-c") };
        let mut command = Command::new(shell);
        command.arg(flag).arg(&self.command).stdin(Stdio::null());
        command.envs(variables.iter().map(|variable| (variable.name, &variable.lines)));
        if self.is_json {
            command.stdout(io::stderr());
        }
        // A group of its own, which can be ended as a whole.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        command.spawn()
    }
}

/// Waits until `child` ends; `None` when it was ended on `stop`.
fn wait(mut child: Child, stop: &AtomicBool) -> io::Result<Option<ExitStatus>> {
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status));
        }
        if stop.load(Ordering::Acquire) {
            end(&mut child);
            return Ok(None);
        }
        thread::sleep(PAUSE);
    }
}

/// Ends `child` and all that it started: asks, waits, then kills.
#[cfg(unix)]
fn end(child: &mut Child) {
    use nix::sys::signal::{Signal, killpg};
    use nix::unistd::Pid;

    let Ok(id) = i32::try_from(child.id()) else { return };
    let start = Instant::now();
    // The group is there until the last of it has ended: with a signal of `None` nothing is sent.
    let is_there = |signal: Option<Signal>| killpg(Pid::from_raw(id), signal).is_ok();
    let mut is_running = is_there(Some(Signal::SIGTERM));
    while is_running && start.elapsed() < GRACE {
        thread::sleep(PAUSE);
        let _ = child.try_wait();
        is_running = is_there(None);
    }
    if is_running {
        is_there(Some(Signal::SIGKILL));
    }
    let _ = child.wait();
}

/// Ends `child`.
#[cfg(not(unix))]
fn end(child: &mut Child) {
    let _ = child.kill();
    let _ = child.wait();
}

/// A variable of the command's environment.
struct Variable {
    name: &'static str,
    /// One path per line; none at all where they are too many for a variable.
    lines: OsString,
    left_out: Vec<HookError>,
}

/// Lists `paths` in the variable `name`, but for those that would be two lines.
fn lines(name: &'static str, paths: &[PathBuf]) -> Variable {
    let mut variable = Variable { name, lines: OsString::new(), left_out: Vec::new() };
    for path in paths {
        if path.as_os_str().as_encoded_bytes().iter().any(|byte| matches!(byte, b'\n' | b'\r')) {
            variable.left_out.push(HookError::LineBreak { path: path.clone(), variable: name });
            continue;
        }
        if !variable.lines.is_empty() {
            variable.lines.push("\n");
        }
        variable.lines.push(path);
    }
    if variable.lines.len() > MAX_BYTES {
        variable.lines.clear();
    }
    variable
}
