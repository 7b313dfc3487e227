//! Random documents. Each edit is compared with the same edit of the tree of `serde_json`.

use proptest::prelude::*;
use serde_json::{Map, Value};

use super::{Json, parse};

/// Returns JSON texts of every spelling, with unusual white space, escapes and numbers.
fn any_text() -> impl Strategy<Value = String> {
    let blank = || "[ \t\n\r]{0,2}";
    let scalar = prop_oneof![
        Just("null".to_owned()),
        Just("true".to_owned()),
        "-?(0|[1-9][0-9]{0,25})(\\.[0-9]{1,5})?([eE][+-]?[0-9]{1,2})?",
        any_quoted(),
    ];
    scalar.prop_recursive(4, 24, 4, move |inner| {
        let item = (blank(), inner, blank()).prop_map(|(before, value, after)| format!("{before}{value}{after}"));
        let member =
            (blank(), any_quoted(), blank(), item.clone()).prop_map(|(a, key, b, item)| format!("{a}{key}{b}:{item}"));
        let list = |entries: Vec<String>, blank: String| {
            if entries.is_empty() { blank } else { entries.join(",") }
        };
        prop_oneof![
            (prop::collection::vec(item, 0..4), blank())
                .prop_map(move |(items, blank)| format!("[{}]", list(items, blank))),
            (prop::collection::vec(member, 0..4), blank())
                .prop_map(move |(members, blank)| format!("{{{}}}", list(members, blank))),
        ]
    })
}

fn any_quoted() -> impl Strategy<Value = String> {
    let piece = prop_oneof![
        "[a-c/~:]",
        Just("é\u{1f600}".to_owned()),
        Just("\\\"".to_owned()),
        Just("\\\\".to_owned()),
        Just("\\ud83d\\uDE00".to_owned()),
        Just("\\u0061".to_owned()),
        Just("\\n".to_owned()),
    ];
    prop::collection::vec(piece, 0..3).prop_map(|pieces| format!("\"{}\"", pieces.concat()))
}

/// Adds the pointers of `value` and of all values in it to `found`.
fn pointers(value: &Value, pointer: &str, found: &mut Vec<String>) {
    found.push(pointer.to_owned());
    match value {
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, item)| pointers(item, &format!("{pointer}/{i}"), found))
        }
        Value::Object(members) => members.iter().for_each(|(key, member)| {
            let key = key.replace('~', "~0").replace('/', "~1");
            pointers(member, &format!("{pointer}/{key}"), found);
        }),
        _ => {}
    }
}

fn any_pointer(text: &str, pick: prop::sample::Index) -> (Value, String) {
    let value: Value = serde_json::from_str(text).unwrap();
    let mut found = Vec::new();
    pointers(&value, "", &mut found);
    let pointer = pick.get(&found).clone();
    (value, pointer)
}

/// Returns the lengths of the texts that `before` and `after` have in common at the start and at the end.
fn common(before: &str, after: &str) -> (usize, usize) {
    let front = before.bytes().zip(after.bytes()).take_while(|(a, b)| a == b).count();
    let rest = before.len().min(after.len()) - front;
    let back = before.bytes().rev().zip(after.bytes().rev()).take(rest).take_while(|(a, b)| a == b).count();
    (front, back)
}

fn any_value() -> impl Strategy<Value = Value> {
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<i64>().prop_map(Value::from),
        any::<f64>().prop_map(Value::from),
        "\\PC{0,4}".prop_map(Value::from)
    ];
    leaf.prop_recursive(3, 12, 3, |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..3).prop_map(Value::from),
            prop::collection::vec(("[a-d]", inner), 0..3)
                .prop_map(|members| Value::Object(members.into_iter().collect::<Map<_, _>>())),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_document_keeps_every_byte(text in any_text()) {
        let json = parse(&text);
        prop_assert_eq!(json.to_string(), &*text);
        prop_assert_eq!(json.value("").unwrap().unwrap(), serde_json::from_str::<Value>(&text).unwrap());
    }

    #[test]
    fn replacing_changes_one_value(text in any_text(), pick: prop::sample::Index, new in any_value()) {
        let (mut value, pointer) = any_pointer(&text, pick);
        let mut json = parse(&text);
        let old = json.text(&pointer).unwrap().into_owned();
        json.set(&pointer, &new).unwrap();
        *value.pointer_mut(&pointer).unwrap() = new;
        let after = json.to_string();
        prop_assert_eq!(serde_json::from_str::<Value>(&after).unwrap(), value);
        let (front, back) = common(&text, &after);
        prop_assert!(text.len() - front - back <= old.len());
        prop_assert_eq!(json.text(&pointer).unwrap().len() + text.len(), old.len() + after.len());
        prop_assert_eq!(Json::parse(after.as_bytes()).unwrap().to_string(), after);
    }

    #[test]
    fn adding_keeps_the_rest(text in any_text(), pick: prop::sample::Index, new in any_value()) {
        let (mut value, pointer) = any_pointer(&text, pick);
        let mut json = parse(&text);
        match value.pointer_mut(&pointer).unwrap() {
            Value::Array(items) => {
                prop_assert_eq!(json.push(&pointer, &new).unwrap(), items.len());
                items.push(new);
            }
            Value::Object(members) => {
                json.set(&format!("{pointer}/added"), &new).unwrap();
                members.insert("added".to_owned(), new);
            }
            _ => prop_assert!(json.push(&pointer, &new).is_err()),
        }
        let after = json.to_string();
        prop_assert_eq!(serde_json::from_str::<Value>(&after).unwrap(), value);
        let (front, back) = common(&text, &after);
        let replaced = &text[front..text.len() - back];
        prop_assert!(replaced.trim().is_empty(), "{:?}", replaced);
    }

    #[test]
    fn removing_keeps_the_rest(text in any_text(), pick: prop::sample::Index) {
        let (mut value, pointer) = any_pointer(&text, pick);
        let mut json = parse(&text);
        let Some((parent, last)) = pointer.rsplit_once('/') else { return Ok(()) };
        prop_assert!(json.remove(&pointer).unwrap());
        match value.pointer_mut(parent).unwrap() {
            Value::Array(items) => drop(items.remove(last.parse().unwrap())),
            Value::Object(members) => drop(members.shift_remove(&last.replace("~1", "/").replace("~0", "~"))),
            _ => unreachable!("a parent holds something"),
        }
        let after = json.to_string();
        prop_assert_eq!(serde_json::from_str::<Value>(&after).unwrap(), value);
        let mut rest = text.bytes();
        prop_assert!(after.bytes().all(|byte| rest.any(|other| other == byte)), "{} is no part of {}", after, text);
    }

    #[test]
    fn any_bytes_are_read_as_serde_json_reads_them(bytes in prop_oneof![
        prop::collection::vec(any::<u8>(), 0..64).boxed(),
        "[\\[\\]{}:,\"\\\\ \nu0-9eE.+-truefalsn]{0,24}".prop_map(String::into_bytes).boxed(),
    ]) {
        if let Ok(json) = Json::parse(&bytes) {
            prop_assert_eq!(json.to_bytes(), bytes);
        } else {
            prop_assert!(serde_json::from_slice::<Value>(&bytes).is_err());
        }
    }

    #[test]
    fn damaged_documents_do_not_panic(text in any_text(), at: prop::sample::Index, byte: u8) {
        let mut bytes = text.into_bytes();
        let index = at.index(bytes.len());
        bytes[index] = byte;
        let _ = Json::parse(&bytes);
        bytes.truncate(index);
        let _ = Json::parse(&bytes);
    }
}
