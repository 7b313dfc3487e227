use super::*;

#[test]
fn names_are_unique_and_portable() {
    let mut names = Names::new("helmet");
    assert_eq!(names.unique("Brass", "normal"), "helmet.roughcast/Brass.normal");
    assert_eq!(names.unique("brass", "normal"), "helmet.roughcast/brass.normal-2");
    assert_eq!(names.unique("Brass", "roughness"), "helmet.roughcast/Brass.roughness");
    assert_eq!(names.unique("a/b:c*", "normal"), "helmet.roughcast/a_b_c_.normal");
    assert_eq!(names.unique("BRASS", "normal"), "helmet.roughcast/BRASS.normal-3");
    assert_eq!(Names::new("a:b\\c").unique("Brass", "normal"), "a_b_c.roughcast/Brass.normal");
}

/// If every name tried all smaller numbers first, there would be 5 * 10^9 tries.
#[test]
fn numbers_many_textures_of_one_name_quickly() {
    let mut names = Names::new("helmet");
    let last = (0..100_000).map(|_| names.unique("image", "normal")).last();
    assert_eq!(last.as_deref(), Some("helmet.roughcast/image.normal-100000"));
}

#[test]
fn long_names_are_cut_between_characters_and_stay_different() {
    assert_eq!(fit_name("brass", 5), "brass");
    for (letter, max) in [("a", 40), ("ü", 40), ("ü", 41), ("\u{1f4a7}", 43)] {
        let long = letter.repeat(100);
        let (first, second) = (fit_name(&format!("{long}1"), max), fit_name(&format!("{long}2"), max));
        assert!(first.len() <= max && first.len() + 4 > max && second.len() <= max, "{first}");
        assert!(first.starts_with(letter) && first != second, "{first}");
        assert_eq!(first, fit_name(&format!("{long}1"), max));
    }
}
