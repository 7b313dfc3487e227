//! `--on-change`.

use std::ffi::OsString;
use std::io;
use std::path::PathBuf;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use super::events::Changes;

/// Largest variable: Linux takes 128 KiB.
const MAX_BYTES: usize = 100_000;

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
}

impl Hook {
    /// Of `--on-change`; with `--json` the command prints to standard error.
    pub fn new(command: &str, is_json: bool) -> Self {
        Self { command: command.to_owned(), is_json }
    }

    /// Runs it and waits for it, or ends it on `stop`.
    pub fn run(&self, changes: &Changes, stop: &AtomicBool) -> Result<(), HookError> {
        let failed = |error| HookError::Start { command: self.command.clone(), error };
        let mut child = self.start(changes).map_err(failed)?;
        let status = loop {
            if let Some(status) = child.try_wait().map_err(failed)? {
                break status;
            }
            if stop.load(Ordering::Acquire) {
                let _ = child.kill();
                let _ = child.wait();
                return Ok(());
            }
            thread::sleep(Duration::from_millis(5));
        };
        if status.success() { Ok(()) } else { Err(HookError::Failed { command: self.command.clone(), status }) }
    }

    fn start(&self, changes: &Changes) -> io::Result<Child> {
        let (shell, flag) = if cfg!(windows) { ("cmd", "/C") } else { ("sh", "-c") };
        let mut command = Command::new(shell);
        command.arg(flag).arg(&self.command).stdin(Stdio::null());
        command.env("ROUGHCAST_OUTPUTS", lines(&changes.outputs)).env("ROUGHCAST_REMOVED", lines(&changes.removed));
        if self.is_json {
            command.stdout(io::stderr());
        }
        command.spawn()
    }
}

/// One path per line; none at all where they are too many for a variable.
fn lines(paths: &[PathBuf]) -> OsString {
    let lines = paths.iter().fold(OsString::new(), |mut lines, path| {
        if !lines.is_empty() {
            lines.push("\n");
        }
        lines.push(path);
        lines
    });
    if lines.len() > MAX_BYTES { OsString::new() } else { lines }
}
