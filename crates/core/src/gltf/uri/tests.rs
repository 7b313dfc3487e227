//! Paths inside the folder, paths that leave it, and data.

use std::path::{Component, Path};

use proptest::prelude::*;

use super::{MAX_PATH_URI, Uri, UriError, encode_path, relative_path};

fn path(uri: &str) -> String {
    let path = relative_path(uri).expect(uri);
    path.iter().map(|name| name.to_str().unwrap()).collect::<Vec<_>>().join("/")
}

fn error(uri: &str) -> String {
    Uri::parse(uri).expect_err(uri).to_string()
}

fn decode(uri: &str, limit: usize) -> Result<Vec<u8>, UriError> {
    match Uri::parse(uri)? {
        Uri::Data(data) => data.decode(limit),
        Uri::Path(path) => panic!("{} is no data", path.display()),
    }
}

#[test]
fn decodes_and_normalises_paths() {
    for (uri, expected) in [
        ("a.png", "a.png"),
        ("./textures//a%20b.png", "textures/a b.png"),
        ("my textures/é%C3%A9.png", "my textures/éé.png"),
        ("a/../b.png", "b.png"),
        ("a/b/%2e%2E/./../c.png", "c.png"),
        ("100%.png", "100%.png"),
        ("%25zz%2", "%zz%2"),
        ("%252e%252e/a", "%2e%2e/a"),
        ("what%3F%23.png", "what?#.png"),
        ("...", "..."),
        ("..a/.b", "..a/.b"),
    ] {
        assert_eq!(path(uri), expected);
        assert!(matches!(Uri::parse(uri), Ok(Uri::Path(path)) if path == Path::new(expected)));
    }
    assert_eq!(path(&"a".repeat(MAX_PATH_URI)).len(), MAX_PATH_URI);
}

#[test]
fn rejects_paths_outside_the_folder_and_names_the_error() {
    let outside = |uri: &str| {
        format!("expected a path inside the folder of the asset, found \"{uri}\"; move the file into that folder")
    };
    for uri in ["../a.png", "a/../../b.png", "%2e%2e/a.png", ".%2E/a", "a/../..", "../folder/a.png"] {
        assert_eq!(error(uri), outside(uri));
    }
    for uri in ["/etc/passwd", "//host/share/a.png", "C:/a.png", "c:\\a.png", "C:a.png"] {
        let expected =
            format!("expected a path relative to the asset, found \"{uri}\"; store the file beside the asset");
        assert_eq!(error(uri), expected);
    }
    for uri in ["", ".", "./", "a/..", "a/", "a/.", "//"] {
        assert!(matches!(relative_path(uri), Err(UriError::NotAFile { .. } | UriError::Absolute { .. })), "{uri}");
    }
    assert_eq!(error(""), "expected the path of a file, found \"\"; name the file");
    for scheme in ["http", "HTTPS", "file", "blob", "urn+x.y-1"] {
        let expected = format!(
            "expected a relative path or a data URI, found the scheme \"{scheme}:\"; store the file beside the asset"
        );
        assert_eq!(error(&format!("{scheme}://host/a.png")), expected);
    }
    assert_eq!(error("a#b.png"), "expected a path, found '#' in \"a#b.png\"; if it is part of a name, write %23");
    assert_eq!(error("a.png?v=1"), "expected a path, found '?' in \"a.png?v=1\"; if it is part of a name, write %3F");
    for (uri, found) in [
        ("a\\b.png", "'\\\\'"),
        ("a%5Cb.png", "'\\\\'"),
        ("..%2f..%2fb.png", "'/'"),
        ("%43%3A/b.png", "':'"),
        ("d/a:b.png", "':'"),
        ("a\0.png", "'\\0'"),
        ("a%00.png", "'\\0'"),
    ] {
        let expected = format!(
            "expected a file name without '/', '\\', ':' and NUL, found {found} in \"{uri}\"; separate folders by '/' or \
             rename the file"
        );
        assert_eq!(error(uri), expected);
    }
    assert_eq!(
        error("%ff.png"),
        "expected percent-encoded UTF-8, found other bytes in \"%ff.png\"; encode the name as UTF-8"
    );
    assert!(error(&"a".repeat(MAX_PATH_URI + 1)).starts_with("expected a path of at most 4096 bytes, found 4097;"));
    assert!(error(&format!("{}:", "a".repeat(1 << 20))).len() < 256);
    assert!(matches!(relative_path("data:,x"), Err(UriError::Scheme { .. })));
}

#[test]
fn decodes_data() {
    for (uri, mime, expected) in [
        ("data:image/png;base64,iVBORw0KGgo=", "image/png", &b"\x89PNG\r\n\x1a\n"[..]),
        ("DATA:application/octet-stream;x=y;BASE64,AAEC", "application/octet-stream", &[0, 1, 2]),
        ("data:;base64,AA%3D%3D", "", &[0]),
        ("data:;base64,AA", "", &[0]),
        ("data:;base64,", "", &[]),
        ("data:text/plain,a%20b,%ff", "text/plain", b"a b,\xff"),
        ("data:,", "", &[]),
    ] {
        let Ok(Uri::Data(data)) = Uri::parse(uri) else { panic!("{uri}") };
        assert_eq!(data.mime(), mime);
        assert_eq!(data.decode(expected.len()).unwrap(), expected, "{uri}");
    }
}

#[test]
fn bounds_and_checks_data() {
    assert_eq!(
        error("data:image/png"),
        "expected ',' between the media type and the data of a data URI, found none; export the asset again"
    );
    let wrong = decode("data:;base64,A*==", 9).unwrap_err().to_string();
    assert!(wrong.starts_with("expected base64 (RFC 4648 section 4) in a data URI, found: "), "{wrong}");
    for (uri, length) in
        [("data:;base64,AAECAwQFBgc=", 8), ("data:,abc", 3), ("data:,%61%62", 2), ("data:;base64,%41%41", 1)]
    {
        assert_eq!(decode(uri, length).unwrap().len(), length);
        assert!(matches!(decode(uri, length - 1), Err(UriError::DataTooLarge { .. })), "{uri}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn encoded_paths_are_read_back(names in prop::collection::vec("[^/\\\\:\0]{1,8}", 1..4)) {
        prop_assume!(names.iter().all(|name| name != "." && name != ".."));
        let plain = names.join("/");
        let uri = encode_path(&plain);
        prop_assert!(uri.bytes().all(|b| b.is_ascii_alphanumeric() || b"-._~/%".contains(&b)));
        prop_assert_eq!(path(&uri), plain);
    }

    #[test]
    fn accepted_uris_are_plain_relative_paths(uri in prop_oneof!["\\PC{0,16}", "[./%2eEfFc:C\\\\a-]{0,16}"]) {
        if let Ok(path) = relative_path(&uri) {
            prop_assert!(path.components().count() > 0);
            prop_assert!(path.components().all(|part| matches!(part, Component::Normal(_))), "{:?}", path);
        }
    }

    #[test]
    fn decoding_does_not_panic(
        head in "[a-z/;=]{0,8}(;base64)?",
        payload in "[A-Za-z0-9+/=%,]{0,24}",
        limit in 0usize..24,
    ) {
        if let Ok(data) = decode(&format!("data:{head},{payload}"), limit) {
            prop_assert!(data.len() <= limit);
        }
    }
}
