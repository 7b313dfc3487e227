//! The dependencies of outputs, as a Makefile that Make and Ninja read.

use std::path::{Path, PathBuf};

use crate::run::job::Job;
use crate::run::plan_assets::PlannedAsset;

/// ASCII punctuation that GNU Make 4.3 and Ninja 1.11 both read as part of a name.
///
/// Other punctuation is refused. `:;=|` and the globs `*?[]` are syntax of Make. `<>^` and the backtick end a name in
/// Ninja, and so do quotes and `&` before Ninja 1.13. Neither reader has an escape for them that the other reader
/// understands. `\` is read in four ways. `$` has the escape `$$`, which runs the text behind it in a Makefile with
/// `.SECONDEXPANSION`.
const PLAIN: &str = "-_./+,@~!(){}";

/// A name that no depfile can hold.
#[derive(Debug, thiserror::Error)]
#[error(
    "--depfile: expected a path that Make and Ninja can read, found {found} in {}; rename the file or its folder, or \
     leave --depfile out",
    path.display()
)]
pub struct DepfileError {
    path: PathBuf,
    found: String,
}

/// Returns a rule for the document of `job`: it depends on all files that the job read, and on `configs`.
///
/// # Errors
/// [`DepfileError`] for the first path that Make or Ninja would read as anything else.
fn rule(job: &Job, configs: &[PathBuf]) -> Result<String, DepfileError> {
    let document = job.outputs.first().map_or(Path::new(""), |output| &output.path);
    let mut rule = target(document)? + ":";
    let inputs = job.inputs.iter().filter(|input| input.blake3.is_some()).map(|input| &input.path);
    for input in inputs.chain(configs) {
        rule += " \\\n  ";
        rule += &escaped(input)?;
    }
    Ok(rule + "\n")
}

/// Removes the jobs whose rules cannot be written from `planned`. Returns the rules of the other jobs, and the removed
/// jobs.
pub fn split_depfile(
    planned: &mut Vec<PlannedAsset>,
    configs: &[PathBuf],
) -> (String, Vec<(PlannedAsset, DepfileError)>) {
    let (mut rules, mut refused) = (String::new(), Vec::new());
    for asset in std::mem::take(planned) {
        match asset.job.as_ref().map(|job| rule(job, configs)) {
            Ok(Err(error)) => refused.push((asset, error)),
            written => {
                rules += written.ok().and_then(Result::ok).as_deref().unwrap_or_default();
                planned.push(asset);
            }
        }
    }
    (rules, refused)
}

/// Returns `path` as the target of a rule. A `%` would make the rule a pattern, and Ninja reads `\%` as two characters.
fn target(path: &Path) -> Result<String, DepfileError> {
    match escaped(path) {
        Ok(escaped) if escaped.contains('%') => Err(refused(path, "'%'".to_owned())),
        result => result,
    }
}

/// Returns `path` as Make and Ninja read it: blanks and `#` behind a `\`, everything else as it is.
fn escaped(path: &Path) -> Result<String, DepfileError> {
    let text = path.to_str().ok_or_else(|| refused(path, "bytes that are not UTF-8".to_owned()))?;
    let text = if cfg!(windows) { text.replace('\\', "/") } else { text.to_owned() };
    // Both readers know the letter of a drive.
    let drive = if cfg!(windows) && text.get(1..2) == Some(":") { 2 } else { 0 };
    let mut escaped = text[..drive].to_owned();
    for c in text[drive..].chars() {
        match c {
            ' ' | '#' => escaped.extend(['\\', c]),
            '%' => escaped.push(c),
            _ if c.is_alphanumeric() || PLAIN.contains(c) || !(c.is_ascii() || c.is_control()) => escaped.push(c),
            _ => return Err(refused(path, format!("{c:?}"))),
        }
    }
    // `~` at the start is a home folder. `)` at the end closes the member list of an archive. A blank at the end would
    // join the next line.
    match (text.chars().next(), text.chars().next_back()) {
        (Some('~'), _) => Err(refused(path, "'~' at the start".to_owned())),
        (_, Some(c @ (')' | ' '))) => Err(refused(path, format!("{c:?} at the end"))),
        _ => Ok(escaped),
    }
}

fn refused(path: &Path, found: String) -> DepfileError {
    DepfileError { path: path.to_owned(), found }
}

#[cfg(test)]
mod tests;
