//! `roughcast init`.

use std::io::{self, Write};
use std::path::PathBuf;

use super::terminal::outcome::Outcome;
use crate::output::Guard;
use crate::project::{FILE_NAME, TEMPLATE};
use crate::text::printable;

/// Write a roughcast.toml with every setting as a comment.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  roughcast init assets")]
pub struct Args {
    /// The folder of the assets.
    #[arg(default_value = ".", value_name = "DIR")]
    folder: PathBuf,
}

/// Writes the file. An existing file stays as it is.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &Args, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    let path = args.folder.join(FILE_NAME);
    let written = Guard::default().reserve_file(&path).map_err(io::Error::other);
    match written.and_then(|output| output.write_new(TEMPLATE.as_bytes())) {
        Ok(()) => {
            writeln!(out, "wrote {}", printable(&path.display().to_string()))?;
            Ok(Outcome::Done)
        }
        Err(error) => {
            writeln!(
                err,
                "error: {}: expected to write a new file, found: {error}; remove the file or name another folder",
                path.display()
            )?;
            Ok(Outcome::Failed)
        }
    }
}
