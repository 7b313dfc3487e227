//! Identity, edits, and texts that are not JSON.

mod properties;

use std::fmt::Debug;
use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use super::{Json, JsonError, MAX_DEPTH};

const PRETTY: &str =
    "{\n  \"asset\": {\n    \"version\": \"2.0\"\n  },\n  \"list\": [\n    1,\n    2\n  ],\n  \"none\": {}\n}\n";
const TABS: &str = "{\r\n\t\"asset\":{\r\n\t\t\"version\":\"2.0\"\r\n\t},\
    \r\n\t\"m\":[\r\n\t\t{\r\n\t\t\t\"c\":[1.0e+00, -0,0.10]\r\n\t\t}\r\n\t]\r\n}";
const ODD: &str = "\u{feff} \t\r\n{ \"a\\u0041\" :[ ] ,\"\" : {\n} , \
    \"n\":[1.0e+00,-0,123456789012345678901234567890,1E5,-0.0e-0],\
    \"\\ud83d\\ude00\": \"\\/\u{1f600}\\\"\", \"dup\":1,\"dup\":2 }\n\n ";

fn parse(text: &str) -> Json {
    Json::parse(text.as_bytes()).expect(text)
}

/// Returns `text` after one edit.
fn edited<T, E: Debug>(text: &str, edit: impl FnOnce(&mut Json) -> Result<T, E>) -> String {
    let mut json = parse(text);
    edit(&mut json).expect("edit");
    json.to_string()
}

fn message(bytes: &[u8]) -> String {
    Json::parse(bytes).expect_err("not JSON").to_string()
}

#[test]
fn unedited_documents_keep_every_byte() {
    for text in [PRETTY, TABS, ODD, "null", " 1 ", "\"\"", "[]", "{}", "[ [ ] , { } ]"] {
        assert_eq!(parse(text).to_bytes(), text.as_bytes());
    }
}

#[test]
fn opened_documents_keep_every_byte() {
    for text in [PRETTY, TABS, ODD] {
        let mut json = parse(text);
        assert!(!json.remove("/nothing/here").unwrap());
        json.set("/dup", &json!([{}])).unwrap();
        assert!(json.remove("/dup").unwrap());
        for pointer in ["/n", "/list", "/m", "/m/0/c", "/none", ""] {
            let _ = json.retain(pointer, |_| true);
        }
        let expected = text.replace(", \"dup\":1,\"dup\":2 }", " }");
        assert_eq!(json.to_string(), expected);
    }
}

#[test]
fn real_files_keep_every_byte() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let Ok(folders) = fs::read_dir(&data) else {
        return crate::skip::skip(&format!("{} does not exist", data.display()));
    };
    let mut files = 0;
    for folder in folders.flatten() {
        for file in fs::read_dir(folder.path()).into_iter().flatten().flatten() {
            let path = file.path();
            if path.extension().is_some_and(|extension| extension == "gltf") {
                let bytes = fs::read(&path).unwrap();
                let mut json = Json::parse(&bytes).unwrap();
                assert_eq!(json.to_bytes(), bytes, "{}", path.display());
                json.push("/extensionsUsed", "X_test").unwrap();
                json.set("/materials/0/extensions/X_test", &json!({"texture": {"index": 0}})).unwrap();
                let view: Value = serde_json::from_slice(&json.to_bytes()).unwrap();
                assert_eq!(view["materials"][0]["extensions"]["X_test"]["texture"]["index"], 0);
                files += 1;
            }
        }
    }
    assert!(files > 0, "no glTF under {}", data.display());
}

#[test]
fn reads_by_pointer() {
    let mut json = parse(ODD);
    for _ in 0..2 {
        assert_eq!(json.text("/n/0").unwrap(), "1.0e+00");
        assert_eq!(json.text("/dup").unwrap(), "2");
        assert_eq!(json.text("/aA").unwrap(), "[ ]");
        assert_eq!(json.text("/").unwrap(), "{\n}");
        assert_eq!(json.read::<String>("/\u{1f600}").unwrap().unwrap(), "/\u{1f600}\"");
        assert_eq!(json.value("/n/1").unwrap(), Some(json!(-0.0)));
        assert_eq!(json.len("/n"), Some(5));
        assert_eq!(json.len(""), Some(6));
        for nothing in ["/n/5", "/n/-", "/n/01", "/n/+1", "/x", "/n/0/0", "n", "/~2"] {
            assert_eq!(json.text(nothing), None, "{nothing}");
            assert_eq!(json.read::<u8>(nothing).unwrap(), None);
        }
        assert!(matches!(json.read::<bool>("/n"), Err(JsonError::Read { .. })));
        json.retain("/n", |_| true).unwrap();
    }
    assert_eq!(parse(r#"{"a/b~c":{"~1":3}}"#).text("/a~1b~0c/~01").unwrap(), "3");
}

#[test]
fn additions_follow_the_layout_of_the_document() {
    let member = |json: &mut Json| json.set("/none/x/y", &json!([{"k": [1, 2]}]));
    assert_eq!(
        edited(PRETTY, member),
        PRETTY.replace(
            "{}",
            "{\n    \"x\": {\n      \"y\": [\n        {\n          \"k\": [\n            1,\n            2\n          ]\n        }\n      ]\n    }\n  }"
        )
    );
    assert_eq!(edited(PRETTY, |json| json.push("/list", &3)), PRETTY.replace("2\n  ]", "2,\n    3\n  ]"));
    assert_eq!(
        edited(TABS, |json| json.set("/m/0/d", &json!({"e": ["f", "g"]}))),
        TABS.replace("0.10]", "0.10],\r\n\t\t\t\"d\":{\r\n\t\t\t\t\"e\":[\"f\", \"g\"]\r\n\t\t\t}")
    );
    assert_eq!(
        edited(TABS, |json| json.push("/used", "x")),
        TABS.replace("\t]\r\n}", "\t],\r\n\t\"used\":[\"x\"]\r\n}")
    );
    let compact = r#"{"a":[1],"b":{"c":null}}"#;
    assert_eq!(
        edited(compact, |json| json.set("/b/d", &json!({"e": [1, 2]}))),
        r#"{"a":[1],"b":{"c":null,"d":{"e":[1,2]}}}"#
    );
    assert_eq!(edited(compact, |json| json.push("/a", &2)), r#"{"a":[1,2],"b":{"c":null}}"#);
    assert_eq!(edited("{ \"a\": 1 }", |json| json.set("/b", &json!([1, 2]))), "{ \"a\": 1, \"b\": [1, 2] }");
    assert_eq!(edited("{}", |json| json.set("/a", &json!({"b": 1}))), r#"{"a":{"b":1}}"#);
    assert_eq!(edited("[]\n", |json| json.push("", &json!({}))), "[{}]\n");
}

#[test]
fn replacing_and_removing_keep_the_rest() {
    assert_eq!(edited(ODD, |json| json.set("/n/2", &true)), ODD.replace("123456789012345678901234567890", "true"));
    assert_eq!(edited(ODD, |json| json.set("/dup", "x")), ODD.replace("\"dup\":2", "\"dup\":\"x\""));
    assert_eq!(edited(PRETTY, |json| json.remove("/list/0")), PRETTY.replace("\n    1,", ""));
    assert_eq!(edited(PRETTY, |json| json.remove("/list/1")), PRETTY.replace(",\n    2", ""));
    assert_eq!(
        edited(PRETTY, |json| json.remove("/asset/version")),
        PRETTY.replace("\n    \"version\": \"2.0\"\n  ", "")
    );
    assert_eq!(edited(PRETTY, |json| json.retain("/list", |_| false)), PRETTY.replace("\n    1,\n    2\n  ", ""));
    assert_eq!(edited("[0, 1, 2, 3, 4]", |json| json.retain("", |i| i % 2 == 1)), "[1, 3]");
    assert_eq!(edited(" {\"a\":1} ", |json| json.set("", &json!([]))), " [] ");
}

#[test]
fn floats_are_written_in_their_shortest_form() {
    let floats = edited("{}", |json| json.set("/a", &[0.1f32, 1.0, 1e-7]));
    assert_eq!(floats, r#"{"a":[0.1,1.0,1e-7]}"#);
    assert_eq!(edited("{}", |json| json.set("/a", &0.1f64)), r#"{"a":0.1}"#);
}

#[test]
fn removing_an_addition_restores_the_text() {
    for (text, array) in [("{ \"a\" : [ \n] }", "/a"), (PRETTY, "/list"), (PRETTY, "/used")] {
        let mut json = parse(text);
        let index = json.push(array, &json!({"b": 1})).unwrap();
        assert!(json.remove(&format!("{array}/{index}")).unwrap());
        json.remove("/used").unwrap();
        assert_eq!(json.to_string(), text);
    }
}

#[test]
fn refused_edits_change_nothing() {
    let mut json = parse(PRETTY);
    let error = json.set("/asset/version/x", &1).unwrap_err();
    assert!(error.to_string().starts_with("nothing at \"/asset/version/x\": \"x\" is neither"));
    assert!(matches!(json.set("/list/2", &1), Err(JsonError::NoSuchPlace { .. })));
    assert!(matches!(json.set("/list/2/a/b", &1), Err(JsonError::NoSuchPlace { .. })));
    assert!(matches!(json.push("/asset", &1), Err(JsonError::NotAnArray { .. })));
    assert!(matches!(json.retain("/asset", |_| true), Err(JsonError::NotAnArray { .. })));
    for pointer in ["asset", "/~", "/a~2"] {
        assert!(matches!(json.set(pointer, &1), Err(JsonError::Pointer { .. })), "{pointer}");
        assert!(matches!(json.remove(pointer), Err(JsonError::Pointer { .. })), "{pointer}");
    }
    assert!(matches!(json.remove(""), Err(JsonError::Pointer { .. })));
    let not_json = std::collections::BTreeMap::from([((1, 2), 3)]);
    assert!(matches!(json.set("/x", &not_json), Err(JsonError::Value(_))));
    assert!(matches!(json.set(&"/x".repeat(MAX_DEPTH + 1), &1), Err(JsonError::EditTooDeep { .. })));
    assert!(matches!(json.push(&"/x".repeat(MAX_DEPTH), &1), Err(JsonError::EditTooDeep { .. })));
    assert_eq!(json.to_string(), PRETTY);
    json.set(&"/x".repeat(MAX_DEPTH), &1).unwrap();
    assert_eq!(parse(&json.to_string()).text(&"/x".repeat(MAX_DEPTH)).unwrap(), "1");
}

#[test]
fn errors_have_line_column_and_expectation() {
    for (text, expected) in [
        ("", "line 1, column 1: expected a value, found the end of the text"),
        ("{\n \"a\" 1}", "line 2, column 6: expected ':' after the member name, found '1'"),
        ("{\"é\":1,}", "line 1, column 8: expected a member name in double quotes, found '}'"),
        ("[1\n\n2]", "line 3, column 1: expected ',' or ']', found '2'"),
        ("{\"a\":1]", "line 1, column 7: expected ',' or '}', found ']'"),
        ("[1,]", "line 1, column 4: expected a value, found ']'"),
        ("nul", "line 1, column 1: expected null, found 'n'"),
        ("{} x", "line 1, column 4: expected the end of the document, found 'x'"),
        ("\"\u{1}\"", "line 1, column 2: expected a string character or a closing '\"', found U+0001"),
        ("\"\\x\"", "line 1, column 3: expected one of \"\\/bfnrtu after a backslash, found 'x'"),
        ("\"\\u12g4\"", "line 1, column 6: expected a hexadecimal digit, found 'g'"),
        ("[\"\\ud800\"]", "line 1, column 3: expected a pair of \\u surrogates, found half of one; remove it"),
        ("1.", "line 1, column 3: expected a digit, found the end of the text"),
    ] {
        let message = message(text.as_bytes());
        assert_eq!(message.trim_end_matches("; fix the text there, or export it again"), expected);
    }
    assert_eq!(
        message(b"{\n\"\xff\":1}"),
        "line 2, column 2: expected UTF-8, found other bytes; save the file as UTF-8"
    );
}

#[test]
fn rejects_texts_that_rfc_8259_does_not_allow() {
    for text in [
        "01",
        "-",
        "+1",
        ".5",
        "1.e1",
        "1e",
        "1e+",
        "0x1",
        "NaN",
        "Infinity",
        "True",
        "'a'",
        "\"a\nb\"",
        "\"a",
        "{a:1}",
        "{1:1}",
        "[1 2]",
        "[,]",
        "{,}",
        "[1",
        "{\"a\"",
        "{\"a\":",
        "{\"a\":1",
        "[}",
        "//c\n1",
        "1 2",
        "\u{a0}1",
        "1\u{b}",
        "\u{feff}\u{feff}1",
        "\"\\udc00\"",
        "\"\\ud800\\n\"",
        "\"\\ud800\\u0041\"",
        "\"\\ud800\\ud800\"",
        "1\0",
    ] {
        assert!(Json::parse(text.as_bytes()).is_err(), "{text:?}");
    }
}

#[test]
fn depth_is_bounded() {
    let nested = |depth: usize| "[".repeat(depth) + &"]".repeat(depth);
    let deepest = parse(&nested(MAX_DEPTH));
    assert!(deepest.value("").is_ok());
    assert_eq!(deepest.text(&"/0".repeat(MAX_DEPTH - 1)).unwrap(), "[]");
    let error = message(nested(MAX_DEPTH + 1).as_bytes());
    assert_eq!(
        error,
        "line 1, column 128: expected at most 127 nested objects and arrays, found more; nest fewer of them"
    );
    assert!(message("{\"a\":".repeat(1_000_000).as_bytes()).contains("nested"));
}

#[test]
fn every_truncation_is_an_error() {
    for text in [PRETTY, TABS, ODD] {
        for end in 0..text.trim_end().len() {
            assert!(Json::parse(&text.as_bytes()[..end]).is_err(), "{end} bytes");
        }
    }
}
