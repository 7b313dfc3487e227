use super::*;

fn check(json: &[u8]) -> Result<(), FormatError> {
    check_format(json, "plan", 3, "plan again")
}

#[test]
fn accepts_the_expected_format_version_only() {
    assert_eq!(check(br#"{"formatVersion":3,"jobs":[]}"#), Ok(()));
    for (json, found) in [(&br#"{"formatVersion":4}"#[..], Some(4)), (b"{}", None), (br#"{"jobs":[]}"#, None)] {
        let error = FormatError { kind: "plan", expected: 3, found, remedy: "plan again" };
        assert_eq!(check(json), Err(error));
    }
}

#[test]
fn leaves_broken_json_to_the_reader_of_the_whole_file() {
    for json in [&b"{"[..], b"no JSON", b"[]]", br#"{"formatVersion":"3"}"#] {
        assert_eq!(check(json), Ok(()));
    }
}

#[test]
fn errors_name_what_was_expected_what_was_found_and_what_to_do() {
    let error = check(b"{}").expect_err("no format version");
    assert_eq!(error.to_string(), "expected a plan of formatVersion 3, found none; plan again");
}
