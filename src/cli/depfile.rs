//! What outputs depend on, as a Makefile that Make and Ninja read.

use std::path::{Path, PathBuf};

use crate::plan::Job;

/// A rule for the document of each job: all that the job read, and `configs`.
pub fn depfile<'j>(jobs: impl Iterator<Item = &'j Job>, configs: &[PathBuf]) -> String {
    let rule = |job: &Job| {
        let document = job.outputs.first().map_or(Path::new(""), |output| &output.path);
        let inputs = job.inputs.iter().filter(|input| input.blake3.is_some()).map(|input| input.path.as_path());
        let inputs = inputs.chain(configs.iter().map(PathBuf::as_path)).map(escaped);
        inputs.fold(format!("{}:", escaped(document)), |rule, input| format!("{rule} \\\n  {input}")) + "\n"
    };
    jobs.map(rule).collect()
}

/// Make splits names at blanks, comments at `#` and expands `$`; both readers take `\` before the former and `$$`.
fn escaped(path: &Path) -> String {
    let mut escaped = String::new();
    for c in path.to_string_lossy().chars() {
        match c {
            ' ' | '#' => escaped.extend(['\\', c]),
            '$' => escaped.push_str("$$"),
            _ => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_escaped_as_make_reads_them() {
        assert_eq!(escaped(Path::new("a b/#1 $x.gltf")), "a\\ b/\\#1\\ $$x.gltf");
    }
}
