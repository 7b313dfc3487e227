//! Command line of Roughcast.

use std::io;
use std::process::ExitCode;

use clap::Parser;
use roughcast::cli::{Cli, run};

fn main() -> ExitCode {
    let cli = Cli::parse();
    match run(cli, &mut io::stdout(), &mut io::stderr()) {
        Ok(outcome) => outcome.code().into(),
        // A reader that has seen enough (`roughcast ... | head`) is no failure.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: expected to write output, found: {error}");
            ExitCode::from(4)
        }
    }
}
