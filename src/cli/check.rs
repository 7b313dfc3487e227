//! `roughcast check`.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use rayon::prelude::*;
use walkdir::WalkDir;

use super::Outcome;
use super::head::read_head;
use crate::bake::read_file;
use crate::check::{self, Code, Finding, Findings, Origin, Report, Scope, Usage};
use crate::gltf::document::Document;

/// Read baked files again and report what engines would stumble over, or what is not up to date.
///
/// Reads documents, headers and provenance, and hashes sources; with --deep decodes every texel too. Ends with exit code 3
/// when there is an error or a warning; notes alone are fine. docs/findings.md explains each finding.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  roughcast check baked --source assets --deep --format json")]
pub struct Args {
    /// .gltf, .glb or .ktx2 files, or folders of them.
    #[arg(required = true, value_name = "BAKED")]
    baked: Vec<PathBuf>,
    /// Folder of the sources: compare them with the digests that were recorded when they were baked.
    #[arg(long, value_name = "DIR")]
    source: Option<PathBuf>,
    /// Decode every level, and check its texels.
    #[arg(long)]
    deep: bool,
    /// How to print the findings.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
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

/// A file to check.
struct Target {
    path: PathBuf,
    /// Its place below the argument: that of its source below the source folder.
    below: PathBuf,
}

/// Checks what `args` name.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &Args, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<Outcome> {
    let mut outcome = Outcome::Done;
    let mut targets = Vec::new();
    for argument in &args.baked {
        match find(argument) {
            Ok(found) => targets.extend(found),
            Err(error) => {
                writeln!(err, "error: {}: expected a baked file or folder, found: {error}", argument.display())?;
                outcome = outcome.and(Outcome::Failed);
            }
        }
    }
    let (textures, documents): (Vec<_>, Vec<_>) = targets.into_iter().partition(|t| has_extension(&t.path, "ktx2"));
    let mut report = Report { version: env!("CARGO_PKG_VERSION"), files: Vec::new(), findings: Vec::new() };
    let mut named: BTreeSet<PathBuf> = BTreeSet::new();
    let checked: Vec<_> = documents.par_iter().map(|target| args.check_document(target)).collect();
    let is_named = |named: &BTreeSet<PathBuf>, path: &Path| fs::canonicalize(path).is_ok_and(|p| named.contains(&p));
    for (target, result) in documents.iter().zip(checked) {
        match result {
            Ok(checked) => {
                report.files.push(target.path.display().to_string());
                report.findings.extend(checked.findings);
                named.extend(checked.files);
            }
            Err(error) => {
                unreadable(&target.path, &error, err)?;
                outcome = outcome.and(Outcome::Failed);
            }
        }
    }
    let bare: Vec<&Target> = textures.iter().filter(|target| !is_named(&named, &target.path)).collect();
    let checked: Vec<_> = bare.par_iter().map(|target| args.check_texture(target)).collect();
    for (target, result) in bare.iter().zip(checked) {
        match result {
            Ok(findings) => {
                report.files.push(target.path.display().to_string());
                report.findings.extend(findings);
            }
            Err(error) => {
                unreadable(&target.path, &error, err)?;
                outcome = outcome.and(Outcome::Failed);
            }
        }
    }
    let text = match args.format {
        Format::Text => check::text(&report),
        Format::Json => check::json(&report)?,
        Format::Sarif => check::sarif(&report)?,
        Format::Junit => check::junit(&report)?,
    };
    out.write_all(text.as_bytes())?;
    Ok(if report.is_failure() { outcome.and(Outcome::Findings) } else { outcome })
}

/// Documents and textures at `argument`, in a fixed order.
fn find(argument: &Path) -> io::Result<Vec<Target>> {
    if !fs::metadata(argument)?.is_dir() {
        let known = ["gltf", "glb", "ktx2"].iter().any(|e| has_extension(argument, e));
        let name = argument.file_name().map(PathBuf::from).filter(|_| known);
        let below = name.ok_or_else(|| io::Error::other("a file that is neither .gltf, .glb nor .ktx2"))?;
        return Ok(vec![Target { path: argument.to_owned(), below }]);
    }
    let mut targets = Vec::new();
    for entry in WalkDir::new(argument).follow_links(true).sort_by_file_name() {
        let entry = entry?;
        if entry.file_type().is_file() && ["gltf", "glb", "ktx2"].iter().any(|e| has_extension(entry.path(), e)) {
            let below = entry.path().strip_prefix(argument).unwrap_or(entry.path()).to_owned();
            targets.push(Target { path: entry.into_path(), below });
        }
    }
    if targets.is_empty() { Err(io::Error::other("no .gltf, .glb or .ktx2 files in it")) } else { Ok(targets) }
}

fn unreadable(path: &Path, error: &io::Error, err: &mut dyn Write) -> io::Result<()> {
    writeln!(err, "error: {}: expected a readable file, found: {error}", path.display())
}

/// What was found in a document and the files that it refers to.
struct Checked {
    findings: Vec<Finding>,
    /// Real paths of those files.
    files: Vec<PathBuf>,
}

impl Args {
    fn check_document(&self, target: &Target) -> io::Result<Checked> {
        let bytes = read_file(&target.path)?;
        let name = target.path.display().to_string();
        let folder = target.path.parent().unwrap_or(Path::new(""));
        let mut findings = Findings::new(&name, "");
        let source_path = self.source.as_ref().map(|folder| folder.join(&target.below));
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
        let scope = Scope { is_deep: self.deep, origin: origin.as_ref() };
        let checked = check::check_document(&name, &bytes, &|path| self.read(&folder.join(path)), &scope);
        let mut findings = findings.into_list();
        findings.extend(checked.findings);
        let files = checked.files.iter().filter_map(|file| fs::canonicalize(folder.join(file)).ok()).collect();
        Ok(Checked { findings, files })
    }

    /// Checks a texture that no document names.
    fn check_texture(&self, target: &Target) -> io::Result<Vec<Finding>> {
        let bytes = self.read(&target.path)?;
        let mut findings = Findings::new(target.path.display().to_string(), "");
        if is_of_document(&target.below) {
            let message = "expected a document that names it, found none: an earlier bake left it behind; delete it";
            findings.add(Code::LeftOver, "", message);
        } else {
            let folder = self.source.as_ref().map(|f| f.join(target.below.parent().unwrap_or(Path::new(""))));
            let read_source = |path: &Path| read_file(&folder.as_deref().unwrap_or(Path::new("")).join(path));
            let origin = folder.as_ref().map(|_| Origin::new(None, &read_source));
            let scope = Scope { is_deep: self.deep, origin: origin.as_ref() };
            check::check_texture(&bytes, Usage::default(), &scope, &mut findings);
        }
        Ok(findings.into_list())
    }

    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        if self.deep { read_file(path) } else { read_head(path) }
    }
}

/// The document that `path` was baked from: of the same name, in either container.
fn source_document(path: &Path) -> Result<Document, String> {
    let candidates = [path.to_owned(), path.with_extension("gltf"), path.with_extension("glb")];
    let existing = candidates.iter().find(|c| c.is_file()).ok_or("no .gltf or .glb of that name")?;
    let bytes = read_file(existing).map_err(|e| e.to_string())?;
    Document::parse(&bytes).map_err(|e| e.to_string())
}

/// Whether `bake` would have put it there for a document: into a folder `<stem>.roughcast`.
fn is_of_document(below: &Path) -> bool {
    below.parent().is_some_and(|folder| has_extension(folder, "roughcast"))
}

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension))
}
