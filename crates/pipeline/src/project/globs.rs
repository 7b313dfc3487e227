//! Globs of `[[override]]`. A stranger may have written them, so their size is checked before they are compiled.

use globset::{Glob, GlobBuilder, GlobSet, GlobSetBuilder};

/// Longest pattern, in bytes: a quarter of the longest path of Linux.
const MAX_BYTES: usize = 1024;

/// Deepest nesting of braces. `globset` compiles braces recursively, and its stack overflows at a depth of 150.
const MAX_NESTING: usize = 8;

/// Number of characters of a pattern that a message shows.
const SHOWN: usize = 64;

/// A glob that cannot be compiled.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GlobError {
    /// The glob is too long.
    #[error(
        "expected a glob of at most {MAX_BYTES} bytes, found one of {bytes}: {pattern:?}...; write several shorter ones"
    )]
    TooLong {
        /// The beginning of the glob.
        pattern: String,
        /// The length of the glob.
        bytes: usize,
    },
    /// Braces are nested too deeply.
    #[error(
        "expected at most {MAX_NESTING} braces within each other, found {depth} in {pattern:?}; write several globs"
    )]
    TooDeep {
        /// The beginning of the glob.
        pattern: String,
        /// Depth of the nesting.
        depth: usize,
    },
    /// The text is not a glob.
    #[error("expected a glob such as \"props/**\", found {pattern:?}: {reason}; correct the glob")]
    Syntax {
        /// The beginning of the glob.
        pattern: String,
        /// What is wrong with the glob.
        reason: String,
    },
    /// The globs of an override take too much memory together.
    #[error(
        "expected globs that can be compiled together, found {count} that are too large: {reason}; write fewer or \
         shorter globs"
    )]
    TooLarge {
        /// The number of globs.
        count: usize,
        /// The message of the compiler.
        reason: String,
    },
}

/// Compiles `patterns` to a matcher of the paths that at least one of them matches. As in .gitignore, a pattern without
/// a slash matches in every folder.
///
/// # Errors
/// [`GlobError`] for the first pattern that is not a glob or is too large.
pub fn globs(patterns: &[String]) -> Result<GlobSet, GlobError> {
    let mut set = GlobSetBuilder::new();
    for pattern in patterns {
        set.add(glob(pattern)?);
    }
    let too_large =
        |error: globset::Error| GlobError::TooLarge { count: patterns.len(), reason: error.kind().to_string() };
    set.build().map_err(too_large)
}

fn glob(pattern: &str) -> Result<Glob, GlobError> {
    let shown = || pattern.chars().take(SHOWN).collect::<String>();
    if pattern.len() > MAX_BYTES {
        return Err(GlobError::TooLong { pattern: shown(), bytes: pattern.len() });
    }
    let depth = nesting(pattern);
    if depth > MAX_NESTING {
        return Err(GlobError::TooDeep { pattern: shown(), depth });
    }
    let anywhere = if pattern.contains('/') { pattern.to_owned() } else { format!("**/{pattern}") };
    let glob = GlobBuilder::new(&anywhere).literal_separator(true).build();
    glob.map_err(|error| GlobError::Syntax { pattern: shown(), reason: error.kind().to_string() })
}

/// Returns an upper bound of the nesting depth of braces: escaped braces count too.
fn nesting(pattern: &str) -> usize {
    let (mut depth, mut deepest) = (0_usize, 0);
    for c in pattern.chars() {
        match c {
            '{' => depth += 1,
            '}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        deepest = deepest.max(depth);
    }
    deepest
}

#[cfg(test)]
mod tests;
