use proptest::prelude::*;

use super::*;

/// The digest of no bytes, from the BLAKE3 repository.
const EMPTY: &str = "af1349b9f5f9a1a6a0404dea36dcc9499bcb25c9adc112b7cc9a93cae41f3262";

#[test]
fn a_digest_is_written_as_its_digits_and_read_back() {
    let empty = digest(b"");
    assert_eq!(empty.to_string(), EMPTY);
    assert_eq!(format!("{empty:.12}"), EMPTY[..12]);
    assert_eq!(EMPTY.parse(), Ok(empty));
    let json = serde_json::to_string(&empty).unwrap();
    assert_eq!(json, format!("\"{EMPTY}\""));
    assert_eq!(serde_json::from_str::<Digest>(&json).unwrap(), empty);
    assert_eq!(digest_of(&[7; 1 << 18][..]).unwrap(), (digest(&[7; 1 << 18]), 1 << 18));
}

#[test]
fn rejects_paths_and_other_texts() {
    for text in [
        "",
        "..",
        "/etc/passwd",
        "../../victim",
        &EMPTY[1..],
        &format!("{EMPTY}0"),
        &EMPTY.to_uppercase(),
        &format!("/{}", &EMPTY[1..]),
        &format!(" {}", &EMPTY[1..]),
        &format!("+{}", &EMPTY[1..]),
        &format!("{}é", &EMPTY[2..]),
        &format!("{}\0", &EMPTY[1..]),
    ] {
        assert!(text.parse::<Digest>().is_err(), "{text:?}");
        assert!(serde_json::from_value::<Digest>(text.into()).is_err(), "{text:?}");
    }
    let message = "x".repeat(1000).parse::<Digest>().unwrap_err().to_string();
    assert!(message.len() < 200 && message.contains("64 lower-case hexadecimal digits"), "{message}");
}

proptest! {
    #[test]
    fn only_64_lower_case_digits_are_a_digest(text in "[0-9a-fA-F/.g]{62,66}|[0-9a-f]{64}|\\PC{0,70}") {
        let is_digest = text.len() == 64 && text.bytes().all(|b| b.is_ascii_digit() || (b'a'..=b'f').contains(&b));
        prop_assert_eq!(text.parse::<Digest>().is_ok(), is_digest);
        prop_assert_eq!(serde_json::from_value::<Digest>(text.clone().into()).is_ok(), is_digest);
        if let Ok(digest) = text.parse::<Digest>() {
            prop_assert_eq!(digest.to_string(), text);
        }
    }

    #[test]
    fn digests_sort_as_their_digits(a: [u8; 32], b: [u8; 32]) {
        let (a, b) = (Digest(a), Digest(b));
        prop_assert_eq!(a.cmp(&b), a.to_string().cmp(&b.to_string()));
    }
}
