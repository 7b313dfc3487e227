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
    /// A scene in another format than glTF.
    #[error("{0}; export the scene as glTF 2.0 (.glb or .gltf)")]
    Scene(&'static str),
}

/// The first bytes of scene formats, from which other tools export glTF.
const SCENES: [(&[u8], &str); 10] = [
    (b"Kaydara FBX Binary", "an FBX file"),
    (b"; FBX", "an FBX file"),
    (b"PXR-USDC", "a USD file"),
    (b"#usda", "a USD file"),
    (b"PK\x03\x04", "a ZIP or USDZ archive"),
    (b"BLENDER", "a Blender file"),
    (b"ply\n", "a PLY file"),
    (b"ply\r", "a PLY file"),
    (b"solid ", "an STL file"),
    (b"mtllib ", "an OBJ file"),
];

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
            Self::scene(bytes)
        }
    }

    fn scene(bytes: &[u8]) -> Option<Self> {
        let known = SCENES.iter().find(|(signature, _)| bytes.starts_with(signature));
        // OBJ files begin with a comment, as many texts do. A Radiance HDR image begins with "#?".
        let is_comment = matches!(bytes, [b'#', next, ..] if *next == b' ' || next.is_ascii_alphanumeric());
        let comment = is_comment.then_some("a text such as an OBJ file");
        known.map(|(_, name)| *name).or(comment).map(Self::Scene)
    }
}

#[cfg(test)]
mod tests;
