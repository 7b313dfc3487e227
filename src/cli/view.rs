//! `roughcast view`.

use std::io::{self, Write};

use super::terminal::outcome::Outcome;
use crate::text::printable;

/// Show assets and bakes in a browser: the page is in the npm package, and this command says how to start it.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  npx roughcast view assets out")]
pub struct Args {
    /// Assets, bakes, or folders of them, and the options of the page.
    #[arg(value_name = "PATH", allow_hyphen_values = true)]
    arguments: Vec<String>,
}

/// Says how to start the page.
///
/// # Errors
/// When `err` cannot be written to.
pub fn run(args: &Args, err: &mut dyn Write) -> io::Result<Outcome> {
    let arguments: String = args.arguments.iter().map(|argument| format!(" {}", printable(argument))).collect();
    writeln!(
        err,
        "error: the page of the viewer is in the npm package, not in this binary; run npx roughcast view{arguments}"
    )?;
    Ok(Outcome::Usage)
}
