//! Holds comments and documents to rules of plain English that a program can check: short lines, no riddling openings
//! of sentences, and no citations of documents that are not in the repository.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use walkdir::WalkDir;

const MAX_COLUMNS: usize = 120;

/// Openings that leave the subject of a sentence to be guessed.
const OPENINGS: [&str; 4] = ["It where", "Of", "The same", "As there"];

/// Names of documents that are not in the repository.
const ABSENT: [&str; 3] = ["DESIGN", "STYLE.md", "PEERS"];

/// Folder of optional test materials, which tests and benches may use.
const SHARED: &str = "../shared/";

/// Folders that are not ours or not text.
const LEFT_OUT: [&str; 8] = [".git", "target", "node_modules", "venv", "out", "corpus", "artifacts", "goldens"];

#[test]
fn comments_and_documents_are_in_plain_english() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let is_ours =
        |entry: &walkdir::DirEntry| entry.depth() == 0 || !LEFT_OUT.iter().any(|name| entry.file_name() == *name);
    let mut findings = String::new();
    let mut count = 0;
    for entry in WalkDir::new(root).sort_by_file_name().into_iter().filter_entry(is_ours) {
        let entry = entry.expect("a readable folder");
        let path = entry.path().strip_prefix(root).expect("a path below the repository").to_string_lossy();
        let path = path.replace(std::path::MAIN_SEPARATOR, "/");
        let Some(kind) = Kind::of(&path).filter(|_| entry.file_type().is_file()) else { continue };
        let text = fs::read_to_string(entry.path()).expect("a text in UTF-8");
        for (line, finding) in scan(&path, kind, &text) {
            writeln!(findings, "{path}:{line}: {finding}").expect("a string takes text");
            count += 1;
        }
    }
    assert!(count == 0, "{count} findings:\n{findings}");
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Rust,
    /// TOML or shell: comments begin with `#`.
    Hash,
    Markdown,
    /// Other languages, of which only the length of lines is checked.
    Code,
}

impl Kind {
    fn of(path: &str) -> Option<Self> {
        if path == ".ci/run" {
            return Some(Self::Code);
        }
        match Path::new(path).extension()?.to_str()? {
            "rs" => Some(Self::Rust),
            "toml" | "sh" => Some(Self::Hash),
            "md" => Some(Self::Markdown),
            "py" | "js" | "ts" | "wgsl" | "yml" => Some(Self::Code),
            _ => None,
        }
    }
}

/// A line, split into what a reader reads and the rest.
#[derive(Debug, Default, PartialEq)]
struct Line {
    columns: usize,
    /// Columns of string literals, URLs and targets of links, which cannot be wrapped.
    unbreakable: usize,
    /// Text of a comment or of a document, if the line has some.
    prose: Option<String>,
}

/// Returns the findings of a file with their line numbers.
fn scan(path: &str, kind: Kind, text: &str) -> Vec<(usize, String)> {
    // Released sections of the changelog stay as they were published.
    let text = match path.ends_with("CHANGELOG.md") {
        true => text
            .find("\n## ")
            .and_then(|first| Some(first + 1 + text[first + 1..].find("\n## ")?))
            .map_or(text, |end| &text[..end]),
        false => text,
    };
    let lines = match kind {
        Kind::Rust => rust_lines(text),
        Kind::Hash => text.lines().map(hash_line).collect(),
        Kind::Markdown => markdown_lines(text),
        Kind::Code => text.lines().map(code_line).collect(),
    };
    let mut findings = Vec::new();
    for (number, line) in (1..).zip(&lines) {
        if line.columns.saturating_sub(line.unbreakable) > MAX_COLUMNS {
            findings.push((number, format!("{} columns, expected at most {MAX_COLUMNS}", line.columns)));
        }
    }
    let prose: Vec<Option<&str>> = lines.iter().map(|line| line.prose.as_deref()).collect();
    for (number, opening) in openings(&prose) {
        findings.push((number, format!("a sentence begins with {opening:?}: name its subject")));
    }
    if kind != Kind::Code && !path.ends_with("plain_english.rs") {
        findings.extend(citations(path, kind, text, &lines));
    }
    findings.sort();
    findings
}

/// Returns the line numbers and names of cited documents that are not in the repository. Identifiers in code may have
/// such names.
fn citations(path: &str, kind: Kind, text: &str, lines: &[Line]) -> Vec<(usize, String)> {
    let is_test_folder = |part: &str| [".ci", "benches", "tests"].iter().any(|folder| part.starts_with(folder));
    let may_use_shared = path.split('/').any(is_test_folder) || path.ends_with("tests.rs");
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut findings = Vec::new();
    for (number, (source, line)) in (1..).zip(text.lines().zip(lines)) {
        let prose = if kind == Kind::Markdown { source } else { line.prose.as_deref().unwrap_or_default() };
        let is_cited = |name: &str| {
            let ends = |(at, name): (usize, &str)| (&prose[..at], &prose[at + name.len()..]);
            prose
                .match_indices(name)
                .map(ends)
                .any(|(before, after)| !before.ends_with(is_word) && !after.starts_with(is_word))
        };
        let absent = ABSENT.into_iter().filter(|name| is_cited(name));
        let shared = (!may_use_shared && source.contains(SHARED)).then_some(SHARED);
        let finding = |name| (number, format!("cites {name}, which is not in the repository"));
        findings.extend(absent.chain(shared).map(finding));
    }
    findings
}

/// Returns the line numbers and openings of sentences that begin with one of [`OPENINGS`]. Lines without prose, empty
/// lines and marks of lists end a paragraph.
fn openings(lines: &[Option<&str>]) -> Vec<(usize, &'static str)> {
    let mut findings = Vec::new();
    let mut paragraph = String::new();
    // Where each line of the paragraph begins, with its number.
    let mut starts: Vec<(usize, usize)> = Vec::new();
    for (index, line) in lines.iter().copied().chain([None]).enumerate() {
        let text = line.unwrap_or_default().trim();
        let item = text.trim_start_matches(|c: char| c.is_ascii_digit() || "-*#>. ".contains(c));
        if text.is_empty() || item.len() < text.len() {
            for (at, opening) in sentence_openings(&paragraph) {
                let line = starts.iter().rev().find(|(start, _)| *start <= at).map_or(0, |(_, number)| *number);
                findings.push((line, opening));
            }
            paragraph.clear();
            starts.clear();
        }
        if !item.is_empty() {
            starts.push((paragraph.len(), index + 1));
            paragraph += item;
            paragraph.push(' ');
        }
    }
    findings
}

fn sentence_openings(paragraph: &str) -> Vec<(usize, &'static str)> {
    let ends = paragraph.match_indices(['.', '!', '?']).map(|(at, _)| at + 1);
    let sentences = ends.filter_map(|end| {
        let rest = paragraph[end..].trim_start_matches([')', '"', '`']);
        let sentence = rest.trim_start();
        (sentence.len() < rest.len()).then(|| paragraph.len() - sentence.len())
    });
    let opening = |at: usize| {
        let sentence = paragraph[at..].trim_start_matches(['(', '"', '`']);
        let begins =
            |opening: &&&str| sentence.strip_prefix(**opening).is_some_and(|rest| rest.starts_with([' ', ',']));
        OPENINGS.iter().find(begins).map(|opening| (at, *opening))
    };
    [0].into_iter().chain(sentences).filter_map(opening).collect()
}

/// Splits Rust sources into lines. Comments are prose, string literals are unbreakable.
fn rust_lines(text: &str) -> Vec<Line> {
    #[derive(Clone, Copy, PartialEq)]
    enum State {
        Code,
        LineComment,
        BlockComment,
        /// In a literal that ends with a quote and this many hashes; `true` if backslashes escape.
        Literal(usize, bool),
    }
    let mut state = State::Code;
    let mut lines = Vec::new();
    for source in text.lines() {
        let chars: Vec<char> = source.chars().collect();
        let at = |i: usize| chars.get(i).copied().unwrap_or('\0');
        let mut line = Line { columns: chars.len(), ..Line::default() };
        let mut i = 0;
        while i < chars.len() {
            match state {
                State::Code if at(i) == '/' && at(i + 1) == '/' => {
                    i = (i + 2..).find(|&i| !"/!".contains(at(i))).unwrap_or(i + 2);
                    line.prose = Some(String::new());
                    state = State::LineComment;
                }
                State::Code if at(i) == '/' && at(i + 1) == '*' => {
                    (i, state) = (i + 2, State::BlockComment);
                    line.prose = Some(String::new());
                }
                State::Code if at(i) == '"' => {
                    let hashes = chars[..i].iter().rev().take_while(|c| **c == '#').count();
                    let is_raw = i > hashes && at(i - hashes - 1) == 'r';
                    state = if is_raw { State::Literal(hashes, false) } else { State::Literal(0, true) };
                    (i, line.unbreakable) = (i + 1, line.unbreakable + 1);
                }
                // A character, not a lifetime.
                State::Code if at(i) == '\'' && at(i + 1) == '\\' => {
                    i = (i + 3..chars.len()).find(|&i| at(i) == '\'').map_or(chars.len(), |end| end + 1);
                }
                State::Code if at(i) == '\'' && at(i + 2) == '\'' => i += 3,
                State::Code => i += 1,
                State::BlockComment if at(i) == '*' && at(i + 1) == '/' => (i, state) = (i + 2, State::Code),
                State::LineComment | State::BlockComment => {
                    line.prose.get_or_insert_default().push(at(i));
                    i += 1;
                }
                State::Literal(_, true) if at(i) == '\\' => (i, line.unbreakable) = (i + 2, line.unbreakable + 2),
                State::Literal(hashes, _) => {
                    let ends = at(i) == '"' && chars[i + 1..].iter().take_while(|c| **c == '#').count() >= hashes;
                    (i, line.unbreakable) = (i + 1, line.unbreakable + 1);
                    if ends {
                        state = State::Code;
                    }
                }
            }
        }
        if state == State::LineComment {
            state = State::Code;
        }
        line.unbreakable += line.prose.as_deref().map_or(0, unbreakable);
        lines.push(line);
    }
    lines
}

/// Returns the columns of the words of a text that cannot be wrapped: URLs, and links in Markdown.
fn unbreakable(prose: &str) -> usize {
    let is_link = |word: &&str| word.contains("://") || word.contains("](");
    prose.split_whitespace().filter(is_link).map(|word| word.chars().count()).sum()
}

/// Splits a line of TOML or of a shell script.
fn hash_line(source: &str) -> Line {
    let prose = source.trim_start().strip_prefix('#').filter(|text| !text.starts_with('!')).map(str::to_owned);
    let unbreakable = match &prose {
        Some(prose) => unbreakable(prose),
        None => source.split('"').skip(1).step_by(2).map(|literal| literal.chars().count() + 2).sum(),
    };
    Line { columns: source.chars().count(), unbreakable, prose }
}

/// Measures a line of a language whose comments are not checked.
fn code_line(source: &str) -> Line {
    Line { columns: source.chars().count(), unbreakable: unbreakable(source), prose: None }
}

/// Splits Markdown into lines. Code blocks and tables are no prose, and may be wide.
fn markdown_lines(text: &str) -> Vec<Line> {
    let mut is_code = false;
    let line = |source: &str| {
        let is_fence = source.trim_start().starts_with("```");
        is_code ^= is_fence;
        if is_code || is_fence || source.trim_start().starts_with('|') {
            return Line::default();
        }
        Line { columns: source.chars().count(), unbreakable: unbreakable(source), prose: Some(source.to_owned()) }
    };
    text.lines().map(line).collect()
}

#[test]
fn long_lines_are_found_except_for_literals_and_links() {
    let long = "word ".repeat(30);
    let count = |kind, text: &str| scan("a", kind, text).len();
    assert_eq!(count(Kind::Rust, &format!("// {long}")), 1);
    assert_eq!(count(Kind::Rust, &format!("let a = \"{long}\";")), 0);
    assert_eq!(count(Kind::Rust, &format!("let a = r#\"\n{long}\n\"#; // {long}")), 1);
    assert_eq!(count(Kind::Rust, &format!("// https://{}", "a".repeat(130))), 0);
    assert_eq!(count(Kind::Hash, &format!("# {long}\na = \"{long}\"")), 1);
    assert_eq!(count(Kind::Code, &format!("a = \"{long}\"\n# https://{}\n# Of b", "a".repeat(130))), 1);
    assert_eq!(count(Kind::Markdown, &format!("{long}\n| {long} |\n```\n{long}\n```\n{long}")), 2);
}

#[test]
fn openings_are_found_in_comments_and_documents() {
    let found = |kind, text: &str| scan("a", kind, text).into_iter().map(|(line, _)| line).collect::<Vec<_>>();
    assert_eq!(found(Kind::Rust, "/// Returns a. The\n/// same for b.\nlet a = \"Of c\"; // Of d."), [1, 3]);
    assert_eq!(found(Kind::Rust, "// All are one. (As there are\n// two.) It\n// where"), [1, 2]);
    assert_eq!(
        found(Kind::Rust, "// Offsets. Often of the same kind, e.g. The samest.\nlet q = '\"'; // Of a quote."),
        [2]
    );
    assert_eq!(found(Kind::Markdown, "A line\nof text.\n\n- Of a list\n```\nOf code\n```\n| Of | tables |"), [4]);
    assert_eq!(found(Kind::Hash, "a = 1 # b\n# Of a comment"), [2]);
}

#[test]
fn citations_of_absent_documents_are_found() {
    let count = |path: &str, text: &str| scan(path, Kind::Markdown, text).len();
    assert_eq!(count("docs/a.md", "see DESIGN, section 4\nREDESIGN, DESIGNS and peers\nSTYLE.md"), 2);
    assert_eq!(count("docs/a.md", "reads `../shared/data`"), 1);
    assert_eq!(count("tests/a/b.md", "reads `../shared/data`"), 0);
    assert_eq!(scan("src/a.rs", Kind::Rust, "const PEERS: u32 = 1; // PEERS\nlet a = \"../shared/data\";").len(), 2);
    assert_eq!(count("CHANGELOG.md", "# Changelog\n\n## [Unreleased]\n\n## [0.1.0]\n\nOf old\n"), 0);
}
