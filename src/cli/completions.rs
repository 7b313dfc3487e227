//! `roughcast completions`.

use std::io::{self, Write};

use clap::Command;
use clap_complete::Shell;

use super::terminal::outcome::Outcome;

/// Print the completions of a shell.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  roughcast completions bash > ~/.local/share/bash-completion/completions/roughcast")]
pub struct Args {
    /// The shell.
    #[arg(value_enum)]
    shell: Shell,
}

/// Prints the completions of `command`.
///
/// # Errors
/// When `out` cannot be written to.
pub fn run(args: &Args, mut command: Command, out: &mut dyn Write) -> io::Result<Outcome> {
    let mut text = Vec::new();
    clap_complete::generate(args.shell, &mut command, "roughcast", &mut text);
    out.write_all(&text)?;
    Ok(Outcome::Done)
}
