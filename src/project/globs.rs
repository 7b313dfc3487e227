//! Globs of `[[override]]`, which may come from strangers: bounded before they are compiled.

use globset::{Glob, GlobBuilder, GlobSet, GlobSetBuilder};

/// Longest pattern, in bytes: a quarter of the longest path of Linux.
const MAX_BYTES: usize = 1024;

/// Most braces within braces. `globset` compiles them recursively, and 150 are too many for it.
const MAX_NESTING: usize = 8;

/// Characters of a pattern that a message shows.
const SHOWN: usize = 64;

/// A glob that cannot be matched.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GlobError {
    /// It is too long.
    #[error(
        "expected a glob of at most {MAX_BYTES} bytes, found one of {bytes}: {pattern:?}...; write several shorter ones"
    )]
    TooLong {
        /// Its beginning.
        pattern: String,
        /// Its length.
        bytes: usize,
    },
    /// It has braces within braces within braces.
    #[error(
        "expected at most {MAX_NESTING} braces within each other, found {depth} in {pattern:?}; write several globs"
    )]
    TooDeep {
        /// Its beginning.
        pattern: String,
        /// How many braces are within each other.
        depth: usize,
    },
    /// It is no glob.
    #[error("expected a glob such as \"props/**\", found {pattern:?}: {reason}")]
    Syntax {
        /// Its beginning.
        pattern: String,
        /// What is wrong with it.
        reason: String,
    },
    /// All globs of an override together take too much memory.
    #[error("expected fewer or shorter globs, found {count} that are too large together: {reason}")]
    TooLarge {
        /// How many they are.
        count: usize,
        /// What the compiler says.
        reason: String,
    },
}

/// Returns a matcher of paths that any of `patterns` matches, read as in .gitignore: a name alone is meant in every folder.
///
/// # Errors
/// [`GlobError`] for the first pattern that is none or is too large.
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

/// Returns an upper bound of how many braces are within each other: braces that are escaped count, too.
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
mod tests {
    use super::*;

    fn error(pattern: &str) -> String {
        globs(&[pattern.to_owned()]).expect_err(pattern).to_string()
    }

    #[test]
    fn globs_of_any_size_are_compiled_or_refused() {
        let nested = |depth: usize| format!("{}a{}", "{a,".repeat(depth), "}".repeat(depth));
        assert!(globs(&[nested(MAX_NESTING)]).is_ok());
        assert!(globs(&vec!["?".repeat(MAX_BYTES); 10]).is_ok_and(|set| set.len() == 10));
        assert!(error(&nested(150)).contains("found 150 in \"{a,{a,"), "{}", error(&nested(150)));
        assert!(error(&"?".repeat(200_000)).contains("found one of 200000: \"???"));
        assert!(error("[z-a]").contains("found \"[z-a]\": invalid range"), "{}", error("[z-a]"));
        let many = vec!["[!a]*".repeat(MAX_BYTES / 5); 1000];
        assert!(matches!(globs(&many), Err(GlobError::TooLarge { count: 1000, .. })));
    }
}
