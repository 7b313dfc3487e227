use super::*;

#[test]
fn detects_files_by_their_first_bytes() {
    for (bytes, expected) in [
        (&b""[..], Some(Foreign::Empty)),
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 7\n", Some(Foreign::LfsPointer)),
        (b"\n <!DOCTYPE HTML><title>404</title>", Some(Foreign::WebPage)),
        (b"<html>", Some(Foreign::WebPage)),
        (b"Kaydara FBX Binary  \0\x1a\0", Some(Foreign::Scene("an FBX file"))),
        (b"BLENDER-v402", Some(Foreign::Scene("a Blender file"))),
        (b"#usda 1.0", Some(Foreign::Scene("a USD file"))),
        (b"# Blender 4.2\nv 0 0 0\n", Some(Foreign::Scene("a text such as an OBJ file"))),
        (b"#?RADIANCE\n", None),
        // A TGA image with a comment of 35 bytes.
        (b"#\0\x02", None),
        (b"{\"asset\":{}}", None),
        (b"\x89PNG\r\n\x1a\n", None),
        (b" ", None),
    ] {
        assert_eq!(Foreign::detect(bytes), expected);
    }
}
