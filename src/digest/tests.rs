use proptest::prelude::*;

use super::*;

/// The digest of nothing, from the BLAKE3 repository.
const OF_NOTHING: &str = "af1349b9f5f9a1a6a0404dea36dcc9499bcb25c9adc112b7cc9a93cae41f3262";

#[test]
fn a_digest_is_written_as_its_digits_and_read_back() {
    let of_nothing = digest(b"");
    assert_eq!(of_nothing.to_string(), OF_NOTHING);
    assert_eq!(format!("{of_nothing:.12}"), OF_NOTHING[..12]);
    assert_eq!(OF_NOTHING.parse(), Ok(of_nothing));
    let json = serde_json::to_string(&of_nothing).unwrap();
    assert_eq!(json, format!("\"{OF_NOTHING}\""));
    assert_eq!(serde_json::from_str::<Digest>(&json).unwrap(), of_nothing);
    assert_eq!(digest_of(&[7; 1 << 18][..]).unwrap(), (digest(&[7; 1 << 18]), 1 << 18));
}

#[test]
fn nothing_that_leads_elsewhere_is_a_digest() {
    for text in [
        "",
        "..",
        "/etc/passwd",
        "../../victim",
        &OF_NOTHING[1..],
        &format!("{OF_NOTHING}0"),
        &OF_NOTHING.to_uppercase(),
        &format!("/{}", &OF_NOTHING[1..]),
        &format!(" {}", &OF_NOTHING[1..]),
        &format!("+{}", &OF_NOTHING[1..]),
        &format!("{}é", &OF_NOTHING[2..]),
        &format!("{}\0", &OF_NOTHING[1..]),
    ] {
        assert!(text.parse::<Digest>().is_err(), "{text:?}");
        assert!(serde_json::from_value::<Digest>(text.into()).is_err(), "{text:?}");
    }
    let told = "x".repeat(1000).parse::<Digest>().unwrap_err().to_string();
    assert!(told.len() < 200 && told.contains("64 lower-case hexadecimal digits"), "{told}");
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
    fn digests_have_the_order_of_their_digits(a: [u8; 32], b: [u8; 32]) {
        let (a, b) = (Digest(a), Digest(b));
        prop_assert_eq!(a.cmp(&b), a.to_string().cmp(&b.to_string()));
    }
}
