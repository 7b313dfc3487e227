use super::*;

#[test]
fn detects_files_by_their_first_bytes() {
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
