//! Detection of files that are not what their names say, by their first bytes.

/// What a file is instead of the expected content, and what to do about it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Foreign {
    /// A file without bytes.
    #[error("an empty file; copy or export it again")]
    Empty,
    /// The text that Git LFS checks out instead of a file that was not downloaded.
    #[error("a Git LFS pointer instead of the file; run `git lfs pull`")]
    LfsPointer,
    /// HTML, which servers send instead of files that they do not have.
    #[error("a web page; download the file itself")]
    WebPage,
}

impl Foreign {
    /// Detects whether `bytes` are the start of such a file. Returns `None` if they may be an asset, an image or a
    /// buffer.
    pub fn detect(bytes: &[u8]) -> Option<Self> {
        let text = bytes.trim_ascii_start();
        let starts = |with: &[u8]| text.get(..with.len()).is_some_and(|start| start.eq_ignore_ascii_case(with));
        if bytes.is_empty() {
            Some(Self::Empty)
        } else if bytes.starts_with(b"version https://git-lfs.github.com/spec/") {
            Some(Self::LfsPointer)
        } else if starts(b"<!doctype html") || starts(b"<html") {
            Some(Self::WebPage)
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests;
