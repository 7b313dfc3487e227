//! What outputs depend on, as a Makefile that Make and Ninja read.

use std::path::{Path, PathBuf};

use super::jobs::Planned;
use crate::run::Job;

/// ASCII punctuation that GNU Make 4.3 and Ninja 1.11 both take for part of a name. Of what is left, some characters are
/// Make's syntax (`:;=|` and the globs `*?[]`), others end a name in Ninja (`<>^`, the backtick, and before version 1.13 quotes
/// and `&`), and neither reader has an escape for them that the other one understands. `\` is read in four ways. `$` has the escape `$$`, which runs
/// what stands behind it in a Makefile with `.SECONDEXPANSION`.
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

/// Returns a rule for the document of `job`: it depends on all that the job read, and on `configs`.
///
/// # Errors
/// [`DepfileError`] for the first path that Make or Ninja would take for anything else.
pub fn rule(job: &Job, configs: &[PathBuf]) -> Result<String, DepfileError> {
    let document = job.outputs.first().map_or(Path::new(""), |output| &output.path);
    let mut rule = target(document)? + ":";
    let inputs = job.inputs.iter().filter(|input| input.blake3.is_some()).map(|input| &input.path);
    for input in inputs.chain(configs) {
        rule += " \\\n  ";
        rule += &escaped(input)?;
    }
    Ok(rule + "\n")
}

/// Removes the jobs whose rules cannot be written from `planned`. Returns the rules of the others, and the removed jobs.
pub fn split(planned: &mut Vec<Planned>, configs: &[PathBuf]) -> (String, Vec<(Planned, DepfileError)>) {
    let (mut rules, mut refused) = (String::new(), Vec::new());
    for one in std::mem::take(planned) {
        match one.job.as_ref().map(|job| rule(job, configs)) {
            Ok(Err(error)) => refused.push((one, error)),
            written => {
                rules += written.ok().and_then(Result::ok).as_deref().unwrap_or_default();
                planned.push(one);
            }
        }
    }
    (rules, refused)
}

/// Returns `path` as the target of a rule. A `%` would make the rule a pattern, and `\%` is two characters to Ninja.
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
    // A home folder; the end of an archive's member list; a blank, which the next line would join.
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
mod tests {
    use super::*;

    #[test]
    fn names_are_escaped_as_make_and_ninja_read_them() {
        assert_eq!(escaped(Path::new("a b/#1 (2) 50%.gltf")).unwrap(), "a\\ b/\\#1\\ (2)\\ 50%.gltf");
    }

    #[test]
    fn what_make_or_ninja_would_act_on_is_refused() {
        let in_any = (0..128).map(char::from).filter(|c| !c.is_alphanumeric() && !PLAIN.contains(*c));
        for c in in_any.filter(|c| !" #%".contains(*c)) {
            assert!(escaped(Path::new(&format!("a{c}b"))).is_err(), "{c:?}");
        }
        for name in ["~a/b", "a ", "lib(b)"] {
            assert!(escaped(Path::new(name)).is_err(), "{name}");
        }
        assert!(target(Path::new("50%.gltf")).is_err());
    }
}
