//! Scripts of the repository, run with the tool of this build on their PATH.

use std::env;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Returns the path of a file of the repository.
pub fn in_repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Returns the folder of the tool of this build.
pub fn tool_folder() -> PathBuf {
    Path::new(env!("CARGO_BIN_EXE_roughcast")).parent().expect("a folder").to_owned()
}

/// Returns a command that runs a script of the repository with folders in front of the PATH.
pub fn script(path: &str, folders: &[&Path]) -> Command {
    let mut command = Command::new("bash");
    command.arg(in_repository(path)).env("PATH", path_with(folders));
    command
}

/// Returns the PATH with folders in front of it.
pub fn path_with(folders: &[&Path]) -> std::ffi::OsString {
    let path = env::var_os("PATH").unwrap_or_default();
    let folders = folders.iter().map(|folder| folder.to_path_buf());
    env::join_paths(folders.chain(env::split_paths(&path))).expect("paths")
}

/// Returns the exit code and what a command printed, errors after the rest.
pub fn run(command: &mut Command) -> (i32, String) {
    let Output { status, stdout, stderr } = command.output().expect("a program");
    let text = String::from_utf8_lossy(&stdout).into_owned() + &String::from_utf8_lossy(&stderr);
    (status.code().expect("a code"), text)
}
