//! The command line of Roughcast.

use std::io::{self, ErrorKind};
use std::process::ExitCode;

use clap::Parser;
use roughcast::cli::{Cli, Outcome, run};

fn main() -> ExitCode {
    let outcome = match Cli::try_parse() {
        Ok(cli) => run(cli, &mut io::stdout(), &mut io::stderr()),
        Err(message) => print_message(&message),
    };
    outcome.code().into()
}

/// Prints help, the version, or what is wrong with the arguments.
fn print_message(message: &clap::Error) -> Outcome {
    match (message.use_stderr(), message.print()) {
        (true, _) => Outcome::Usage,
        (false, Err(error)) if error.kind() != ErrorKind::BrokenPipe => Outcome::Retry,
        (false, _) => Outcome::Done,
    }
}
