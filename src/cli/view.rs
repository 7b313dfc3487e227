//! `roughcast view`.

use std::io::{self, BufRead, Write};
use std::path::PathBuf;
use std::thread;

use super::terminal::outcome::Outcome;
use crate::text::printable;
use crate::viewer::{Chosen, Events, PageFile, Server, Site, ViewerError, choose, reports_outputs};

/// The files of the page, if the tool was built with ROUGHCAST_VIEWER (`build.rs`).
const PAGE: Option<&[PageFile]> = include!(concat!(env!("OUT_DIR"), "/viewer_page.rs"));

/// Show an asset, its bakes and a supersampled picture side by side, in a browser.
///
/// The page is served on 127.0.0.1 until Ctrl-C, and its address is printed first. No file leaves the machine. Builds
/// from source do not hold the page, and say how to get it.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  \
    roughcast view                        an empty page: drop your files on it\n  \
    roughcast view model.glb baked.glb    the original and its bake\n  \
    roughcast view assets out             an asset of the folder assets, and its bake of the same name")]
pub struct Args {
    /// Assets, bakes, or folders of them.
    #[arg(value_name = "ASSET|FOLDER")]
    inputs: Vec<PathBuf>,
    /// The original, if its file does not show it to be one.
    #[arg(long, value_name = "ASSET")]
    original: Option<PathBuf>,
    /// Reload the page when `roughcast watch --json`, on standard input, reports new outputs.
    #[arg(long)]
    events: bool,
}

/// Serves the page until the process ends. Returns only if the page cannot be served.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &Args, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    run_with(PAGE, args, out, err)
}

fn run_with(
    page: Option<&'static [PageFile]>,
    args: &Args,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> io::Result<Outcome> {
    let Some(page) = page else { return explain(err) };
    let (server, chosen, events) = match start(args, page) {
        Ok(started) => started,
        Err(reason) => {
            writeln!(err, "error: {reason}")?;
            return Ok(match reason {
                ViewerError::Twice { .. } => Outcome::Usage,
                ViewerError::Listen(_) => Outcome::Retry,
                _ => Outcome::Failed,
            });
        }
    };
    // The server has nothing to finish, so that Ctrl-C is its usual end.
    let _ = ctrlc::set_handler(|| std::process::exit(0));
    writeln!(out, "{}", server.url())?;
    for (variant, path) in &chosen.files {
        writeln!(out, "  {}: {}", variant.title(), printable(&path.display().to_string()))?;
    }
    out.flush()?;
    if chosen.others > 0 {
        writeln!(err, "note: the folders have {} more; name a file to see another asset", chosen.others)?;
    }
    if let Some(events) = events {
        thread::spawn(move || report_bakes(&events));
    }
    server.serve()
}

/// Says where a page can be had.
fn explain(err: &mut dyn Write) -> io::Result<Outcome> {
    writeln!(
        err,
        "error: expected the page of the viewer in this binary, found none, since builds from source leave it out; \
         give the same arguments to `npx roughcast view` (Node.js), to `uvx roughcast view` (Python), or to the \
         roughcast of a release's archive; docs/install.md says how to build it in"
    )?;
    Ok(Outcome::Usage)
}

/// Chooses what to show, and listens.
fn start(args: &Args, page: &'static [PageFile]) -> Result<(Server, Chosen, Option<Events>), ViewerError> {
    let chosen = choose(&args.inputs, args.original.as_deref())?;
    let events = args.events.then(Events::default);
    let server = Server::bind(Site::new(page, &chosen.files)?, events.clone())?;
    Ok((server, chosen, events))
}

/// Reads standard input to its end.
fn report_bakes(events: &Events) {
    for line in io::stdin().lock().lines().map_while(Result::ok) {
        if reports_outputs(&line) {
            events.report_bake();
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        args: Args,
    }

    /// Runs a command line that serves nothing.
    fn run_line(page: Option<&'static [PageFile]>, line: &[&str]) -> (Outcome, String) {
        let Line { args } = Line::try_parse_from([&["view"], line].concat()).expect("arguments");
        let (mut out, mut err) = (Vec::new(), Vec::new());
        let outcome = run_with(page, &args, &mut out, &mut err).expect("streams in memory");
        assert!(out.is_empty());
        (outcome, String::from_utf8(err).expect("UTF-8"))
    }

    #[test]
    fn a_build_without_the_page_names_every_way_to_get_it() {
        let (outcome, text) = run_line(None, &["assets", "out", "--original", "assets/a.gltf", "--events"]);
        assert_eq!(outcome, Outcome::Usage);
        for way in ["npx roughcast view", "uvx roughcast view", "archive", "docs/install.md"] {
            assert!(text.contains(way), "{text}");
        }
    }

    #[test]
    fn an_asset_that_is_missing_fails() {
        let (outcome, text) = run_line(Some(&[]), &["missing.glb"]);
        assert_eq!(outcome, Outcome::Failed);
        assert!(text.starts_with("error: missing.glb: expected a .gltf or .glb file or a folder, found:"), "{text}");
    }
}
