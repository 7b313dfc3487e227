//! `roughcast man`.

use std::fs;
use std::io::{self, Write};
use std::path::PathBuf;

use clap::CommandFactory;

use super::{Cli, Outcome};
use crate::text::printable;

/// Write the manual pages: one for the tool and one for each command.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  roughcast man ~/.local/share/man/man1")]
pub struct Args {
    /// The folder, which is made if it is not there.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Writes them.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &Args, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    let pages = fs::create_dir_all(&args.folder).and_then(|()| clap_mangen::generate_to(Cli::command(), &args.folder));
    match pages {
        Ok(()) => {
            writeln!(out, "wrote {}", printable(&args.folder.display().to_string()))?;
            Ok(Outcome::Done)
        }
        Err(error) => {
            let folder = args.folder.display();
            writeln!(err, "error: {folder}: expected a folder that can be written to, found: {error}")?;
            Ok(Outcome::Failed)
        }
    }
}
