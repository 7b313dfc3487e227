//! `roughcast check`.

mod targets;

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use rayon::prelude::*;
use semver::Version;

use self::targets::{Sources, Target, source_document};
use super::cached::CacheOptions;
use super::files::Folder;
use super::jobs;
use super::report::Status;
use super::selection::SettingOptions;
use super::work::Work;
use crate::bake::read_file;
use crate::check::{self, Code, Files, Finding, Findings, Held, Origin, Report, Scope, Severity, Usage};
use crate::cli::outcome::Outcome;
use crate::settings::Settings;
use crate::text::printable;

/// Read baked files again and report what engines would stumble over, or what is not up to date.
///
/// Reads documents, headers and provenance, and hashes sources; with --deep decodes every texel too. Ends with exit code 3
/// when there is an error or a warning; notes alone are fine. docs/findings.md explains each finding.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  roughcast check baked --source assets --deep --format json\n  \
    roughcast check baked --source assets --fix --cache .cache/roughcast")]
pub struct Args {
    /// .gltf, .glb or .ktx2 files, or folders of them.
    #[arg(required = true, value_name = "BAKED")]
    baked: Vec<PathBuf>,
    /// Folder of the sources: compare them with the digests that were recorded when they were baked, and settings with
    /// those that its roughcast.toml, or flags, ask for today.
    #[arg(long, value_name = "DIR")]
    source: Option<PathBuf>,
    /// Decode every level, and check its texels.
    #[arg(long)]
    deep: bool,
    /// Oldest version of the tool whose outputs will do.
    #[arg(long, value_name = "VERSION")]
    min_version: Option<Version>,
    /// Count a finding as an error, such as RC1510.
    #[arg(long, value_name = "FINDING")]
    deny: Vec<Code>,
    /// Count a finding as a note.
    #[arg(long, value_name = "FINDING")]
    allow: Vec<Code>,
    /// Bake again what has findings that a bake cures, with the settings that hold today; then check again.
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

/// Checks what `args` name.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &Args, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    let sources = match &args.source {
        Some(source) => match Sources::find(source, &args.baked, &args.settings) {
            Ok(sources) => sources,
            Err(reason) => {
                say(err, &format!("error: {reason}"))?;
                return Ok(Outcome::Usage);
            }
        },
        None if args.settings.is_explicit() => {
            writeln!(err, "error: expected --source with settings, found none; name the folder that was baked")?;
            return Ok(Outcome::Usage);
        }
        None => Sources::default(),
    };
    let mut checked = args.check(&sources, err)?;
    if args.fix && !checked.curable.is_empty() {
        let outcome = args.bake(&checked.curable, &sources, err)?;
        checked = args.check(&sources, err)?;
        checked.outcome = checked.outcome.and(outcome);
    }
    let Checked { report, outcome, .. } = checked;
    let text = match args.format {
        Format::Text => check::text(&report),
        Format::Json => check::json(&report)?,
        Format::Sarif => check::sarif(&report)?,
        Format::Junit => check::junit(&report)?,
    };
    out.write_all(text.as_bytes())?;
    Ok(if report.is_failure() { outcome.and(Outcome::Findings) } else { outcome })
}

/// What was found.
struct Checked {
    report: Report,
    /// Whether everything could be read.
    outcome: Outcome,
    /// Assets with findings that a bake cures, by the paths of their outputs without extension.
    curable: BTreeSet<PathBuf>,
}

/// What was found in a document and the files that it refers to.
struct CheckedDocument {
    findings: Vec<Finding>,
    /// Real paths of those files.
    files: Vec<PathBuf>,
}

impl Args {
    fn check(&self, sources: &Sources, err: &mut dyn Write) -> io::Result<Checked> {
        let mut outcome = Outcome::Done;
        let mut targets = Vec::new();
        for argument in &self.baked {
            match targets::find(argument) {
                Ok(found) => targets.extend(found),
                Err(error) => {
                    let path = argument.display();
                    say(err, &format!("error: {path}: expected a baked file or folder, found: {error}"))?;
                    outcome = outcome.and(Outcome::Failed);
                }
            }
        }
        let (textures, documents): (Vec<_>, Vec<_>) = targets.into_iter().partition(Target::is_texture);
        let mut unreadable = |target: &Target, error: &io::Error| {
            outcome = outcome.and(Outcome::Failed);
            say(err, &format!("error: {}: expected a readable file, found: {error}", target.path.display()))
        };
        let (mut files, mut findings, mut curable) = (Vec::new(), Vec::new(), BTreeSet::new());
        let mut named: BTreeSet<PathBuf> = BTreeSet::new();
        let checked: Vec<_> = documents.par_iter().map(|target| self.check_document(target, sources)).collect();
        for (target, result) in documents.iter().zip(checked) {
            match result {
                Ok(mut checked) => {
                    self.judge(&mut checked.findings);
                    let is_curable = |f: &Finding| f.severity != Severity::Note && f.code.is_cured_by_bake();
                    curable.extend(checked.findings.iter().any(is_curable).then(|| target.key()));
                    files.push(target.path.display().to_string());
                    findings.extend(checked.findings);
                    named.extend(checked.files);
                }
                Err(error) => unreadable(target, &error)?,
            }
        }
        let is_named = |path: &Path| fs::canonicalize(path).is_ok_and(|path| named.contains(&path));
        let bare: Vec<&Target> = textures.iter().filter(|target| !is_named(&target.path)).collect();
        let checked: Vec<_> = bare.par_iter().map(|target| self.check_texture(target)).collect();
        for (target, result) in bare.iter().zip(checked) {
            match result {
                Ok(mut found) => {
                    self.judge(&mut found);
                    files.push(target.path.display().to_string());
                    findings.extend(found);
                }
                Err(error) => unreadable(target, &error)?,
            }
        }
        let present: BTreeSet<PathBuf> = documents.iter().map(Target::key).collect();
        for missing in sources.expected.iter().filter(|key| !present.contains(*key)) {
            let Some(asset) = sources.assets.get(missing) else { continue };
            let mut found = Findings::new(asset.input.path.display().to_string());
            let message = format!("expected its output at {}, found none; bake it", missing.display());
            found.add(Code::NoOutput, "", message);
            let mut found = found.into_list();
            self.judge(&mut found);
            findings.extend(found);
            curable.insert(missing.clone());
        }
        let report = Report { version: env!("CARGO_PKG_VERSION"), files, findings };
        Ok(Checked { report, outcome, curable })
    }

    /// What the user takes for an error or a note.
    fn judge(&self, findings: &mut [Finding]) {
        for finding in findings {
            if self.deny.contains(&finding.code) {
                finding.severity = Severity::Error;
            } else if self.allow.contains(&finding.code) {
                finding.severity = Severity::Note;
            }
        }
    }

    fn check_document(&self, target: &Target, sources: &Sources) -> io::Result<CheckedDocument> {
        let bytes = read_file(&target.path)?;
        let name = target.path.display().to_string();
        let folder = target.path.parent().unwrap_or(Path::new(""));
        let mut findings = Findings::new(&name);
        // The output may have a shorter name than its source.
        let known = sources.assets.get(&target.key());
        let source_path = self
            .source
            .as_ref()
            .map(|folder| known.map_or_else(|| folder.join(&target.below), |asset| asset.input.path.clone()));
        let source_folder = source_path.as_deref().and_then(Path::parent).unwrap_or(Path::new("")).to_owned();
        let read_source = |path: &Path| read_file(&source_folder.join(path));
        let origin = source_path.and_then(|path| match source_document(&path) {
            Ok(document) => Some(Origin::new(Some(document), &read_source)),
            Err(reason) => {
                let message =
                    format!("expected the document that this was baked from at {}, found: {reason}", path.display());
                findings.add(Code::MissingSource, "", message);
                None
            }
        });
        // Without a word on settings, any will do; a fix will bake with the defaults then.
        let asset = known.filter(|_| sources.is_configured || self.fix);
        let scope = Scope { settings: asset.map(|asset| &asset.resolved.settings), ..self.scope(origin.as_ref()) };
        let checked = check::check_document(&name, &bytes, &Folder(folder.to_owned()), &scope);
        let mut findings = findings.into_list();
        findings.extend(checked.findings);
        let files = checked.files.iter().filter_map(|file| fs::canonicalize(folder.join(file)).ok()).collect();
        Ok(CheckedDocument { findings, files })
    }

    /// Checks a texture that no document names.
    fn check_texture(&self, target: &Target) -> io::Result<Vec<Finding>> {
        let files = Folder(PathBuf::new());
        let held = Held::read(files.length(&target.path)?, self.deep, |part| files.read(&target.path, part))?;
        let mut findings = Findings::new(target.path.display().to_string());
        if target.is_of_document() {
            let message = "expected a document that names it, found none: an earlier bake left it behind; delete it";
            findings.add(Code::LeftOver, "", message);
        } else {
            let folder = self.source.as_ref().map(|f| f.join(target.below.parent().unwrap_or(Path::new(""))));
            let read_source = |path: &Path| read_file(&folder.as_deref().unwrap_or(Path::new("")).join(path));
            let origin = folder.as_ref().map(|_| Origin::new(None, &read_source));
            check::check_texture(held.as_ktx2(), Usage::default(), &self.scope(origin.as_ref()), &mut findings);
        }
        Ok(findings.into_list())
    }

    fn scope<'a>(&'a self, origin: Option<&'a Origin<'a>>) -> Scope<'a> {
        Scope { is_deep: self.deep, origin, settings: None, min_version: self.min_version.as_ref() }
    }

    /// Bakes the assets whose outputs are `curable`, as `bake` does.
    fn bake(&self, curable: &BTreeSet<PathBuf>, sources: &Sources, err: &mut dyn Write) -> io::Result<Outcome> {
        if let Some(error) = &sources.unsafe_output {
            say(err, &format!("error: {error}"))?;
            return Ok(Outcome::Failed);
        }
        let assets = curable.iter().filter_map(|key| sources.assets.get(key));
        let assets: Vec<_> = assets.map(|asset| (asset.input.clone(), asset.resolved.clone())).collect();
        for (_, resolved) in &assets {
            if let Err(error) = resolved.settings.target.check_available() {
                writeln!(err, "error: {error}")?;
                return Ok(Outcome::Usage);
            }
        }
        let cache = match self.cache.open() {
            Ok(cache) => cache,
            Err(error) => {
                writeln!(err, "error: {error}")?;
                return Ok(Outcome::Usage);
            }
        };
        let (cache, settings) = (cache.as_ref(), Settings::default());
        let work = Work { cache, settings: &settings, remote: None, check: &|_| Ok(()), is_quiet: false };
        let planned = jobs::plan(&assets);
        let mut guard = jobs::guard(&planned, None, &[]);
        let worked = work.run(planned, &mut guard, err, &mut |asset, err| match &asset.output {
            Some(output) if asset.status != Status::Failed => {
                say(err, &format!("baked again: {} -> {output}", asset.input))
            }
            _ => Ok(()),
        })?;
        Ok(worked.outcome)
    }
}

/// Writes a line that names what files hold.
fn say(err: &mut dyn Write, line: &str) -> io::Result<()> {
    writeln!(err, "{}", printable(line))
}
