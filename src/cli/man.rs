//! `roughcast man`.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Command;
use clap_mangen::Man;

use super::terminal::outcome::Outcome;
use crate::output::Guard;
use crate::text::printable;

/// Write the manual pages: one for the tool and one for each command.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  roughcast man ~/.local/share/man/man1")]
pub struct Args {
    /// The folder, which is made if it does not exist.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Writes the pages of `command`.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &Args, command: Command, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    let mut pages = Vec::new();
    // Subcommands have pages of their own, so `help` needs none.
    let mut command = command.disable_help_subcommand(true);
    command.build();
    add_pages(command, &mut pages)?;
    let mut guard = Guard::default();
    let written = pages.iter().try_for_each(|(name, page)| guard.reserve_file(&args.folder.join(name))?.write(page));
    match written {
        Ok(()) => {
            writeln!(out, "wrote {}", printable(&args.folder.display().to_string()))?;
            Ok(Outcome::Done)
        }
        Err(error) => {
            writeln!(err, "error: {error}")?;
            Ok(Outcome::Failed)
        }
    }
}

/// Adds the pages of `command` and its subcommands, each with its file name.
fn add_pages(command: Command, pages: &mut Vec<(String, Vec<u8>)>) -> io::Result<()> {
    for subcommand in command.get_subcommands().filter(|subcommand| !subcommand.is_hide_set()) {
        add_pages(subcommand.clone(), pages)?;
    }
    let (man, mut page) = (Man::new(command), Vec::new());
    man.render(&mut page)?;
    pages.push((man.get_filename(), page));
    Ok(())
}
