//! `roughcast inspect`.

use std::io::{self, Write};
use std::path::PathBuf;

use super::terminal::outcome::Outcome;
use crate::inspect::{Facts, document_text, inspect_file, texture_text};
use crate::text::printable;

/// Print the content of a KTX2 file (levels, format, provenance) or of a glTF document (materials and their textures).
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  roughcast inspect baked/helmet.gltf --extract levels")]
pub struct Args {
    /// .ktx2, .gltf or .glb.
    file: PathBuf,
    /// Print JSON (schemas/inspect.schema.json).
    #[arg(long)]
    json: bool,
    /// Write every level of every KTX2 texture as PNG, or EXR where it holds floats: NAME.level0.png and so on.
    #[arg(long, value_name = "DIR")]
    extract: Option<PathBuf>,
}

/// Inspects the file and prints its content.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &Args, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    match inspect_file(&args.file, args.extract.as_deref()) {
        Err(error) => {
            let line = format!("error: {}: {error}", args.file.display());
            writeln!(err, "{}", printable(&line))?;
            Ok(Outcome::Failed)
        }
        Ok(report) => {
            let name = args.file.display().to_string();
            if args.json {
                writeln!(out, "{}", serde_json::to_string_pretty(&report).map_err(io::Error::other)?)?;
            } else {
                let text = match &report.facts {
                    Facts::Ktx2(facts) => texture_text(&name, facts),
                    Facts::Gltf(facts) => document_text(&name, facts),
                };
                out.write_all(text.as_bytes())?;
                for path in report.pictures {
                    writeln!(out, "wrote {}", printable(&path.display().to_string()))?;
                }
            }
            Ok(Outcome::Done)
        }
    }
}
