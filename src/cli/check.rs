//! `roughcast check`.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::PathBuf;

use clap::ValueEnum;
use semver::Version;

use super::options::cache::CacheOptions;
use super::options::selection::SettingOptions;
use super::terminal::outcome::Outcome;
use super::work::Work;
use crate::cache::CacheError;
use crate::check::{self, Checked, Checker, Code, Sources};
use crate::codec::EncodeError;
use crate::project::SelectionError;
use crate::report::Status;
use crate::run::{guard, plan_assets};
use crate::settings::Settings;

/// Read baked files again and report what engines cannot read or show, and what is out of date.
///
/// Reads documents, headers and provenance, and hashes sources; with --deep also decodes every texel. The exit code is
/// 3 if there is an error or a warning, and 0 if there are notes only. docs/findings.md explains each finding.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  roughcast check baked --source assets --deep --format json\n  \
    roughcast check baked --source assets --fix --cache .cache/roughcast")]
pub struct Args {
    /// .gltf, .glb or .ktx2 files, or folders of them.
    #[arg(required = true, value_name = "BAKED")]
    baked: Vec<PathBuf>,
    /// Folder of the sources, or the one source: compare their digests with those that the bake recorded, and the
    /// recorded settings with the current ones of roughcast.toml and of flags.
    #[arg(long, value_name = "PATH")]
    source: Option<PathBuf>,
    /// Decode every level and check its texels.
    #[arg(long)]
    deep: bool,
    /// Oldest version of the tool whose outputs are accepted.
    #[arg(long, value_name = "VERSION")]
    min_version: Option<Version>,
    /// Count a finding as an error, such as RC1510.
    #[arg(long, value_name = "FINDING")]
    deny: Vec<Code>,
    /// Count a finding as a note.
    #[arg(long, value_name = "FINDING")]
    allow: Vec<Code>,
    /// Bake assets again that have findings which a bake cures, with their current settings; then check again.
    #[arg(long, requires = "source")]
    fix: bool,
    /// How to print the findings.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    #[command(flatten)]
    cache: CacheOptions,
    #[command(flatten)]
    settings: SettingOptions,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Format {
    /// A line per finding, and a summary
    Text,
    /// schemas/check.schema.json
    Json,
    /// SARIF 2.1.0, for code hosts
    Sarif,
    /// JUnit XML, for CI servers
    Junit,
}

/// Why nothing is baked.
#[derive(Debug, thiserror::Error)]
enum FixError {
    #[error(transparent)]
    Encode(#[from] EncodeError),
    #[error(transparent)]
    Cache(#[from] CacheError),
}

/// Why nothing is checked.
#[derive(Debug, thiserror::Error)]
enum CheckCommandError {
    #[error(transparent)]
    Selection(#[from] SelectionError),
    #[error("expected --source with settings, found none; name the folder that was baked")]
    NoSource,
}

/// Checks baked files and prints the findings.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &Args, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    let sources = match args.sources() {
        Ok(sources) => sources,
        Err(reason) => {
            writeln!(err, "error: {reason}")?;
            return Ok(Outcome::Usage);
        }
    };
    let checker = args.checker();
    let (mut checked, mut outcome) = check(&checker, args, &sources, err)?;
    if args.fix && !checked.curable.is_empty() {
        let fixed = args.fix(&checked.curable, &sources, err)?;
        (checked, outcome) = check(&checker, args, &sources, err)?;
        outcome = outcome.and(fixed);
    }
    let report = &checked.report;
    let text = match args.format {
        Format::Text => check::text(report),
        Format::Json => check::json(report)?,
        Format::Sarif => check::sarif(report)?,
        Format::Junit => check::junit(report)?,
    };
    out.write_all(text.as_bytes())?;
    Ok(if report.is_failure() { outcome.and(Outcome::Findings) } else { outcome })
}

/// Checks the files, and prints those that cannot be read.
fn check(checker: &Checker, args: &Args, sources: &Sources, err: &mut dyn Write) -> io::Result<(Checked, Outcome)> {
    let checked = checker.check(&args.baked, sources);
    checked.errors.iter().try_for_each(|error| writeln!(err, "error: {error}"))?;
    let outcome = if checked.errors.is_empty() { Outcome::Done } else { Outcome::Failed };
    Ok((checked, outcome))
}

impl Args {
    fn checker(&self) -> Checker {
        Checker {
            is_deep: self.deep,
            min_version: self.min_version.clone(),
            deny: self.deny.clone(),
            allow: self.allow.clone(),
            expects_defaults: self.fix,
        }
    }

    fn sources(&self) -> Result<Sources, CheckCommandError> {
        let selection = self.settings.selection();
        match &self.source {
            Some(source) => Ok(Sources::find(source, &self.baked, &selection)?),
            None if selection.is_explicit() => Err(CheckCommandError::NoSource),
            None => Ok(Sources::default()),
        }
    }

    /// Bakes the assets of the `curable` outputs, as `bake` does.
    fn fix(&self, curable: &BTreeMap<PathBuf, PathBuf>, sources: &Sources, err: &mut dyn Write) -> io::Result<Outcome> {
        if let Some(error) = &sources.unsafe_output {
            writeln!(err, "error: {error}")?;
            return Ok(Outcome::Failed);
        }
        let asset = |(output, key): (&PathBuf, &PathBuf)| sources.assets.get(key).map(|asset| asset.baked_to(output));
        let assets: Vec<_> = curable.iter().filter_map(asset).collect();
        let open = || -> Result<_, FixError> {
            assets.iter().try_for_each(|(_, resolved)| resolved.settings.target.check_available())?;
            Ok(self.cache.open()?)
        };
        let cache = match open() {
            Ok(cache) => cache,
            Err(error) => {
                writeln!(err, "error: {error}")?;
                return Ok(Outcome::Usage);
            }
        };
        let (cache, settings) = (cache.as_ref(), Settings::default());
        let work = Work { cache, settings: &settings, remote: None, check: &|_| Ok(()), is_quiet: false };
        let planned = plan_assets(&assets);
        let mut guard = guard(&planned, None, &[]);
        let worked = work.run(&planned, &mut guard, err, &mut |asset, err| match &asset.output {
            Some(output) if asset.status != Status::Failed => {
                writeln!(err, "baked again: {} -> {output}", asset.input)
            }
            _ => Ok(()),
        })?;
        Ok(worked.outcome)
    }
}
