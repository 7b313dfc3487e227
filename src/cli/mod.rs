//! The command line: one file per command, each with its `Args` and a `run`. `options` holds groups of options that
//! several commands have, `terminal` what they print with, `work` runs jobs with a progress bar, `threads` starts the
//! thread pool, and `address_space` knows the limit on memory.

mod address_space;
mod bake;
mod check;
mod compare;
mod completions;
mod init;
mod inspect;
mod man;
mod map;
mod options;
mod plan;
mod plan_merge;
mod render;
mod terminal;
mod threads;
mod view;
mod watch;
mod work;

pub use terminal::outcome::Outcome;

use std::io::{self, Write};

use clap::{CommandFactory, Parser, Subcommand};

use crate::memory;
use terminal::streams::{Messages, Results};

/// Bakes the roughness that mipmapped normal maps lose into KTX2 textures and glTF materials.
#[derive(Debug, Parser)]
#[command(name = "roughcast", version, about, max_term_width = 100, arg_required_else_help = true)]
#[command(after_help = "Exit codes: 0 done, 1 some inputs failed permanently (all others are done), 2 wrong usage,\n\
    3 check found something, 4 failed but worth trying again.")]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Number of worker threads, at most 4 per core or 64, whichever is more; 0: one per core. Outputs do not depend on
    /// it.
    #[arg(long, global = true, default_value_t = 0, value_name = "N", display_order = 900)]
    threads: usize,
}

#[derive(Debug, Subcommand)]
enum Command {
    // Boxed for its many options.
    Bake(Box<bake::Args>),
    Init(init::Args),
    Map(map::Args),
    Watch(watch::Args),
    Plan(plan::Args),
    Check(check::Args),
    Inspect(inspect::Args),
    Compare(compare::Args),
    Render(render::Args),
    View(view::Args),
    Completions(completions::Args),
    Man(man::Args),
}

/// Runs a command line. Prints results to `out`, and errors, warnings and progress to `err`.
///
/// Errors of `err` change nothing. If results cannot be printed, the work is done all the same, and the outcome is
/// [`Outcome::Retry`] or worse. A reader that closes `out` is no failure.
pub fn run(cli: Cli, out: &mut dyn Write, err: &mut dyn Write) -> Outcome {
    let (mut results, mut messages) = (Results::new(out), Messages(err));
    let report_print_error = |messages: &mut Messages<'_>, error: &io::Error| {
        let _ = writeln!(messages, "error: expected to print the results, found: {error}; free space and run it again");
        Outcome::Retry
    };
    let outcome = run_command(cli, &mut results, &mut messages);
    let outcome = outcome.unwrap_or_else(|error| report_print_error(&mut messages, &error));
    match results.finish() {
        Ok(()) => outcome,
        Err(error) => outcome.and(report_print_error(&mut messages, &error)),
    }
}

fn run_command(cli: Cli, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    memory::watch_address_space(address_space::left);
    if let Err(error) = threads::start(cli.threads, err) {
        writeln!(err, "error: {error}")?;
        return Ok(Outcome::Retry);
    }
    match cli.command {
        Command::Bake(args) => bake::run(&args, out, err),
        Command::Init(args) => init::run(&args, out, err),
        Command::Map(args) => map::run(&args, out, err),
        Command::Watch(args) => watch::run(&args, out, err),
        Command::Plan(args) => plan::run(&args, out, err),
        Command::Check(args) => check::run(&args, out, err),
        Command::Inspect(args) => inspect::run(&args, out, err),
        Command::Compare(args) => compare::run(&args, out, err),
        Command::Render(args) => render::run(&args, out, err),
        Command::View(args) => view::run(&args, out, err),
        Command::Completions(args) => completions::run(&args, Cli::command(), out),
        Command::Man(args) => man::run(&args, Cli::command(), out, err),
    }
}
