//! `roughcast bake`.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::Outcome;
use super::inputs::Input;
use super::progress::Progress;
use super::report::{Asset, Report, Status};
use super::selection::{Selected, Selection};
use crate::bake::report::AssetReport;
use crate::bake::{
    BakeError, JobError, Places, PublishError, Settings, Source, SourceError, bake, publish, read_file, write_file,
};
use crate::gltf::document::{Container, Document, DocumentError};

/// Bake glTF assets: KTX2 textures with the lost roughness in their mips, and a glTF that refers to them.
///
/// Reads .gltf and .glb files and folders of them; writes to another folder and never touches a source.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  roughcast bake assets/helmet.gltf -o baked --engine bevy")]
pub struct Args {
    /// .gltf or .glb files, or folders that are searched for them.
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<PathBuf>,
    /// Write what was done, chosen and skipped to a JSON file.
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// Print that report instead of a summary.
    #[arg(long)]
    json: bool,
    /// Print errors only.
    #[arg(short, long, conflicts_with = "json")]
    quiet: bool,
    /// Print the settings of each asset and where each comes from, and bake nothing.
    #[arg(long, conflicts_with = "json")]
    print_config: bool,
    #[command(flatten)]
    selection: Selection,
}

/// Why an asset is not baked.
#[derive(Debug, thiserror::Error)]
enum AssetError {
    #[error("expected a readable file, found: {0}")]
    Read(io::Error),
    #[error(transparent)]
    Document(#[from] DocumentError),
    #[error(transparent)]
    Bake(#[from] BakeError),
    #[error(transparent)]
    Publish(#[from] PublishError),
}

impl AssetError {
    /// Whether trying again may help: something was busy or away, not missing or wrong.
    fn is_passing(&self) -> bool {
        let error = match self {
            Self::Read(error)
            | Self::Bake(BakeError::Source(SourceError::Read { error, .. }))
            | Self::Bake(BakeError::Job(JobError::Source { error: SourceError::Read { error, .. }, .. })) => {
                Some(error)
            }
            Self::Publish(error) => error.io(),
            _ => None,
        };
        error.is_some_and(|e| {
            use io::ErrorKind as Kind;
            matches!(
                e.kind(),
                Kind::WouldBlock
                    | Kind::TimedOut
                    | Kind::Interrupted
                    | Kind::ResourceBusy
                    | Kind::StaleNetworkFileHandle
                    | Kind::NetworkDown
                    | Kind::HostUnreachable
            )
        })
    }
}

/// Bakes what `args` name.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &Args, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    let selected = match args.selection.find(&args.inputs) {
        Ok(selected) => selected,
        Err(reason) => {
            writeln!(err, "error: {reason}")?;
            return Ok(Outcome::Usage);
        }
    };
    let (is_safe, mut outcome) = selected.complain(err)?;
    if args.print_config {
        for (input, resolved) in &selected.assets {
            print(out, &format!("# {}\n{resolved}\n", input.path.display()))?;
        }
        return Ok(outcome);
    }
    if !is_safe {
        return Ok(outcome);
    }
    let Selected { assets, errors, settings } = selected;
    let progress = Progress::new(assets.len(), args.quiet);
    let mut report = Report {
        version: env!("CARGO_PKG_VERSION"),
        settings: settings.to_json(settings.model),
        assets: errors.iter().map(|e| Asset::failed(e.path().display().to_string(), 0.0, e.to_string())).collect(),
    };
    let mut places = Places::default();
    for (index, (input, resolved)) in assets.iter().enumerate() {
        let start = Instant::now();
        let name = input.path.display().to_string();
        progress.set(index, 0.0, &name);
        let result = bake_one(input, &resolved.settings, &mut places, &|share| progress.set(index, share, &name));
        let seconds = start.elapsed().as_secs_f64();
        let asset = match result {
            Ok((output, bytes, report)) => Asset {
                input: name,
                output: Some(output.display().to_string()),
                status: if report.textures.is_empty() { Status::Copied } else { Status::Baked },
                settings: Some(&resolved.settings).filter(|own| **own != settings).map(|own| own.to_json(own.model)),
                seconds,
                bytes,
                error: None,
                report,
            },
            Err(error) => {
                outcome = outcome.and(if error.is_passing() { Outcome::Retry } else { Outcome::Failed });
                let message = error.to_string();
                progress.suspend(|| writeln!(err, "error: {name}: {message}"))?;
                Asset::failed(name, seconds, message)
            }
        };
        if !args.quiet && !args.json {
            progress.suspend(|| print(out, &asset.summary()))?;
        }
        report.assets.push(asset);
    }
    progress.finish();
    let mut json = serde_json::to_string_pretty(&report).map_err(io::Error::other)?;
    json.push('\n');
    if let Some(path) = &args.report
        && let Err(error) = write_file(path, json.as_bytes())
    {
        writeln!(err, "error: {error}")?;
        outcome = outcome.and(Outcome::Failed);
    }
    if args.json {
        print(out, &json)?;
    }
    Ok(outcome)
}

/// A reader that has seen enough (`roughcast bake ... | head`) does not end the bake.
fn print(out: &mut dyn Write, text: &str) -> io::Result<()> {
    match out.write_all(text.as_bytes()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        result => result,
    }
}

fn bake_one(
    input: &Input,
    settings: &Settings,
    places: &mut Places,
    advance: &dyn Fn(f32),
) -> Result<(PathBuf, u64, AssetReport), AssetError> {
    let bytes = read_file(&input.path).map_err(AssetError::Read)?;
    let document = Document::parse(&bytes)?;
    let folder = input.path.parent().unwrap_or(Path::new(""));
    let source = Source { stem: &input.stem, document: &document, read: &|path| read_file(&folder.join(path)) };
    let baked = bake(&source, settings, advance)?;
    let extension = if baked.container == Container::Glb { "glb" } else { "gltf" };
    let output = input.folder.join(format!("{}.{extension}", input.stem));
    let bytes = publish(&baked, &output, &input.path, places)?;
    Ok((output, bytes, baked.report))
}
