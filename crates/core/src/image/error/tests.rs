use super::*;

#[test]
fn words_of_decoders_become_one_short_line() {
    assert_eq!(brief("Unknown marker\n 0xFF12\tfound "), "Unknown marker 0xFF12 found");
    let long = brief(&"ä".repeat(10_000));
    assert_eq!(long, format!("{}...", "ä".repeat(LONGEST)));
}

#[test]
fn long_lists_are_cut() {
    assert_eq!(listed(["R", "G"].into_iter()), "R, G");
    let many = vec!["x"; 60_000];
    let list = listed(many.into_iter());
    assert!(list.starts_with("x, x") && list.ends_with("more") && list.len() < LONGEST, "{list}");
    let long = "long".repeat(10_000);
    assert!(listed([long.as_str(); 2].into_iter()).len() < LONGEST);
}
