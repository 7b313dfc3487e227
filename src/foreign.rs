//! Files that hold something else than their names say, told by their first bytes.

/// What a file holds in the place of what was expected, and what to do about it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Foreign {
    /// No byte at all.
    #[error("an empty file; copy or export it again")]
    Empty,
    /// The text that Git LFS checks out in the place of a file that was not downloaded.
    #[error("a Git LFS pointer instead of the file; run `git lfs pull`")]
    LfsPointer,
    /// HTML, which servers send in the place of files that they do not have.
    #[error("a web page; download the file itself")]
    WebPage,
}

impl Foreign {
    /// Returns what `bytes` are if they are the start of no asset, image or buffer at all.
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
mod tests {
    use super::*;

    #[test]
    fn files_are_told_by_their_first_bytes() {
        for (bytes, expected) in [
            (&b""[..], Some(Foreign::Empty)),
            (b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 7\n", Some(Foreign::LfsPointer)),
            (b"\n <!DOCTYPE HTML><title>404</title>", Some(Foreign::WebPage)),
            (b"<html>", Some(Foreign::WebPage)),
            (b"{\"asset\":{}}", None),
            (b"\x89PNG\r\n\x1a\n", None),
            (b" ", None),
        ] {
            assert_eq!(Foreign::detect(bytes), expected);
        }
    }
}
