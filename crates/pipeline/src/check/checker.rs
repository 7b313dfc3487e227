//! Checks files and folders, and collects the findings in a report.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use semver::Version;

use super::checked_files::{
    CheckedFile, Sources, expected_source, find_checked_files, source_document, source_of_unchecked,
};
use super::document::check_document;
use super::files::Files;
use super::findings::{Code, Finding, Findings, Severity};
use super::folder::Folder;
use super::formats::Report;
use super::partial_file::PartialFile;
use super::scope::Scope;
use super::source_digests::SourceDigests;
use super::texture::{Usage, check_texture};
use crate::input_file::read_file;
use crate::output::folder_of;

/// How files are checked.
pub struct Checker {
    /// Whether every texel is decoded.
    pub is_deep: bool,
    /// The oldest version of the tool whose outputs are accepted.
    pub min_version: Option<Version>,
    /// Findings that count as errors.
    pub deny: Vec<Code>,
    /// Findings that count as notes.
    pub allow: Vec<Code>,
    /// Whether assets without explicit settings must have the default settings, since they will be baked with those.
    pub expects_defaults: bool,
}

/// The results of a check.
#[derive(Default)]
pub struct Checked {
    /// The findings.
    pub report: Report,
    /// Messages on files that cannot be read.
    pub errors: Vec<String>,
    /// Outputs with findings that a bake cures, and the keys of their assets in [`Sources`]. A missing output has the
    /// key itself for its path.
    pub curable: BTreeMap<PathBuf, PathBuf>,
}

/// The findings of a document and of the files that it refers to.
struct DocumentFindings {
    findings: Vec<Finding>,
    /// Real paths of the files.
    files: Vec<PathBuf>,
}

impl Checker {
    /// Checks the files and folders `baked` against `sources`.
    pub fn check(&self, baked: &[PathBuf], sources: &Sources) -> Checked {
        let mut checked = Checked::default();
        let mut targets = Vec::new();
        for argument in baked {
            match find_checked_files(argument) {
                Ok(found) => targets.extend(found),
                Err(error) => {
                    let path = argument.display();
                    checked.errors.push(format!("{path}: expected a baked file or folder, found: {error}"));
                }
            }
        }
        let (textures, documents): (Vec<_>, Vec<_>) = targets.into_iter().partition(CheckedFile::is_texture);
        let documents: Vec<_> = documents.into_par_iter().map(|target| (target.key(sources), target)).collect();
        let referred = self.check_documents(&documents, sources, &mut checked);
        self.check_textures(&textures, &referred, sources, &mut checked);
        self.find_missing_outputs(documents.iter().map(|(key, _)| key).collect(), sources, &mut checked);
        checked
    }

    /// Checks `documents`, each with its key, and returns the real paths of the files that they refer to.
    fn check_documents(
        &self,
        documents: &[(PathBuf, CheckedFile)],
        sources: &Sources,
        checked: &mut Checked,
    ) -> BTreeSet<PathBuf> {
        let mut referred = BTreeSet::new();
        let results: Vec<_> =
            documents.par_iter().map(|(key, target)| self.check_document(target, key, sources)).collect();
        for ((key, target), result) in documents.iter().zip(results) {
            let result = result.map(|DocumentFindings { findings, files }| {
                referred.extend(files);
                findings
            });
            let findings = self.add(target, result, checked);
            let is_curable = |f: &Finding| f.severity != Severity::Note && f.code.is_fixed_by_bake();
            if findings.iter().any(is_curable) {
                checked.curable.insert(target.path.clone(), key.clone());
            }
        }
        referred
    }

    /// Checks the textures to which no document refers.
    fn check_textures(
        &self,
        textures: &[CheckedFile],
        referred: &BTreeSet<PathBuf>,
        sources: &Sources,
        checked: &mut Checked,
    ) {
        let is_referred = |path: &Path| fs::canonicalize(path).is_ok_and(|path| referred.contains(&path));
        let standalone: Vec<&CheckedFile> = textures.iter().filter(|target| !is_referred(&target.path)).collect();
        let results: Vec<_> = standalone.par_iter().map(|target| self.check_texture(target, sources)).collect();
        for (target, result) in standalone.iter().zip(results) {
            self.add(target, result, checked);
        }
    }

    /// Adds a finding for every expected output whose key is not among `present`.
    fn find_missing_outputs(&self, present: BTreeSet<&PathBuf>, sources: &Sources, checked: &mut Checked) {
        for missing in sources.expected.iter().filter(|key| !present.contains(*key)) {
            let Some(asset) = sources.assets.get(missing) else { continue };
            let mut findings = Findings::new(asset.input.path.display().to_string());
            let message = format!("expected its output at {}, found none; bake it", missing.display());
            findings.add(Code::NoOutput, "", message);
            let mut findings = findings.into_list();
            self.set_severities(&mut findings);
            checked.report.findings.extend(findings);
            checked.curable.insert(missing.clone(), missing.clone());
        }
    }

    /// Adds the findings of a file to the report, or an error if the file cannot be read. Returns the findings.
    fn add<'c>(
        &self,
        target: &CheckedFile,
        result: io::Result<Vec<Finding>>,
        checked: &'c mut Checked,
    ) -> &'c [Finding] {
        let list = &mut checked.report.findings;
        let start = list.len();
        match result {
            Ok(mut findings) => {
                self.set_severities(&mut findings);
                checked.report.files.push(target.path.display().to_string());
                list.extend(findings);
            }
            Err(error) => {
                let path = target.path.display();
                checked.errors.push(format!("{path}: expected a readable file, found: {error}"));
            }
        }
        &checked.report.findings[start..]
    }

    /// Sets the severities that the user chose.
    fn set_severities(&self, findings: &mut [Finding]) {
        for finding in findings {
            if self.deny.contains(&finding.code) {
                finding.severity = Severity::Error;
            } else if self.allow.contains(&finding.code) {
                finding.severity = Severity::Note;
            }
        }
    }

    fn check_document(&self, target: &CheckedFile, key: &Path, sources: &Sources) -> io::Result<DocumentFindings> {
        let bytes = read_file(&target.path)?;
        let name = target.path.display().to_string();
        let folder = target.path.parent().unwrap_or(Path::new(""));
        let mut findings = Findings::new(&name);
        // The output may have a shorter name than its source, or one that the user chose.
        let known = sources.assets.get(key);
        let source_path = sources
            .folder
            .as_ref()
            .map(|folder| known.map_or_else(|| expected_source(target, folder), |asset| asset.input.path.clone()));
        let source_folder = source_path.as_deref().and_then(Path::parent).unwrap_or(Path::new("")).to_owned();
        let read_source = |path: &Path| read_file(&source_folder.join(path));
        let origin = source_path.and_then(|path| document_digests(&path, &read_source, &mut findings));
        // Without explicit settings, any settings are accepted.
        let asset = known.filter(|_| sources.is_configured || self.expects_defaults);
        let scope = Scope { settings: asset.map(|asset| &asset.resolved.settings), ..self.scope(origin.as_ref()) };
        let checked = check_document(&name, &bytes, &Folder(folder.to_owned()), &scope);
        let mut findings = findings.into_list();
        findings.extend(checked.findings);
        let files = checked.files.iter().filter_map(|file| fs::canonicalize(folder.join(file)).ok()).collect();
        Ok(DocumentFindings { findings, files })
    }

    /// Checks a texture to which no document refers.
    fn check_texture(&self, target: &CheckedFile, sources: &Sources) -> io::Result<Vec<Finding>> {
        let files = Folder(PathBuf::new());
        let held = PartialFile::read(files.length(&target.path)?, self.is_deep, |part| files.read(&target.path, part))?;
        let mut findings = Findings::new(target.path.display().to_string());
        if target.is_of_document() {
            let message = "expected a document that names it, found none: an earlier bake left it behind; delete it";
            findings.add(Code::LeftOver, "", message);
        } else {
            let document = target.unchecked_document();
            let source = sources.folder.as_ref().map(|folder| match &document {
                Some(document) => source_of_unchecked(document, folder),
                None => folder.join(&target.below),
            });
            let folder = source.as_deref().map(folder_of).unwrap_or(Path::new(""));
            let read_source = |path: &Path| read_file(&folder.join(path));
            let origin = source.as_deref().and_then(|source| match document {
                Some(_) => document_digests(source, &read_source, &mut findings),
                None => Some(SourceDigests::new(None, &read_source)),
            });
            check_texture(held.as_ktx2(), Usage::default(), &self.scope(origin.as_ref()), &mut findings);
        }
        Ok(findings.into_list())
    }

    fn scope<'a>(&'a self, origin: Option<&'a SourceDigests<'a>>) -> Scope<'a> {
        Scope { is_deep: self.is_deep, origin, settings: None, min_version: self.min_version.as_ref() }
    }
}

/// Reads the source document at `path`, whose files `read` reads. Adds a finding if there is none.
fn document_digests<'a>(
    path: &Path,
    read: &'a (dyn Fn(&Path) -> io::Result<Vec<u8>> + Sync),
    findings: &mut Findings,
) -> Option<SourceDigests<'a>> {
    match source_document(path) {
        Ok(document) => Some(SourceDigests::new(Some(document), read)),
        Err(reason) => {
            let message =
                format!("expected the document that this was baked from at {}, found: {reason}", path.display());
            findings.add(Code::MissingSource, "", message);
            None
        }
    }
}
