//! The command of `--on-change`.

use std::ffi::OsString;
use std::io;
use std::path::PathBuf;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// The most bytes in a variable: Linux takes 128 KiB.
const MAX_BYTES: usize = 100_000;

/// How long a command may take to end after it was asked to.
const GRACE: Duration = Duration::from_secs(2);

/// The pause between two checks whether a command has ended.
const PAUSE: Duration = Duration::from_millis(5);

/// Outputs that changed.
#[derive(Debug, Default)]
pub struct Changes {
    /// Documents that were written.
    pub outputs: Vec<PathBuf>,
    /// Files that were removed.
    pub removed: Vec<PathBuf>,
}

/// A command of the shell that runs after outputs changed.
pub struct Hook {
    command: String,
    /// Whether the command prints to standard error, since standard output has the JSON lines.
    is_json: bool,
}

/// What went wrong with a command.
#[derive(Debug, thiserror::Error)]
pub enum HookError {
    /// The command could not be started or waited for.
    #[error("expected to run {command:?}, found: {error}; correct the command of --on-change")]
    Start {
        /// The command.
        command: String,
        /// The system's error.
        error: io::Error,
    },
    /// The command ended with another exit code than 0.
    #[error(
        "expected {command:?} to end with exit code 0, found {status}; the outputs are written, correct the command of \
         --on-change"
    )]
    Failed {
        /// The command.
        command: String,
        /// How the command ended.
        status: ExitStatus,
    },
    /// A path with a line break, which would be two paths in the variable.
    #[error(
        "{}: expected a path of one line, found a line break in it; {variable} leaves it out, --json lists it",
        path.display()
    )]
    LineBreak {
        /// The path.
        path: PathBuf,
        /// The variable that leaves the path out.
        variable: &'static str,
    },
}

impl Hook {
    /// Returns the hook that runs `command`; if `is_json`, the command prints to standard error.
    pub fn new(command: &str, is_json: bool) -> Self {
        Self { command: command.to_owned(), is_json }
    }

    /// Runs the command and waits for it; on `stop` ends the command and all processes that it started. Returns what
    /// went wrong.
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
        // A process group of its own can be ended as a whole.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        command.spawn()
    }
}

/// Waits until `child` ends. Returns `None` where it was ended because of `stop`.
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

/// Ends `child` and all processes that it started: asks, waits, then kills.
#[cfg(unix)]
fn end(child: &mut Child) {
    use nix::sys::signal::{Signal, killpg};
    use nix::unistd::Pid;

    let Ok(id) = i32::try_from(child.id()) else { return };
    let start = Instant::now();
    // The group exists until its last process has ended. The signal `None` only asks whether the group exists.
    let signal_group = |signal: Option<Signal>| killpg(Pid::from_raw(id), signal).is_ok();
    let mut is_running = signal_group(Some(Signal::SIGTERM));
    while is_running && start.elapsed() < GRACE {
        thread::sleep(PAUSE);
        let _ = child.try_wait();
        is_running = signal_group(None);
    }
    if is_running {
        signal_group(Some(Signal::SIGKILL));
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
    /// One path per line; empty where they are too many for a variable.
    lines: OsString,
    left_out: Vec<HookError>,
}

/// Lists `paths` in the variable `name`, without paths that have line breaks.
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
