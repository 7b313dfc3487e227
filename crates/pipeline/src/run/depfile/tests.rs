use super::*;

#[test]
fn escapes_names_as_make_and_ninja_read_them() {
    assert_eq!(escaped(Path::new("a b/#1 (2) 50%.gltf")).unwrap(), "a\\ b/\\#1\\ (2)\\ 50%.gltf");
}

#[test]
fn rejects_characters_that_make_or_ninja_would_act_on() {
    let refused = (0..128).map(char::from).filter(|c| !c.is_alphanumeric() && !PLAIN.contains(*c));
    for c in refused.filter(|c| !" #%".contains(*c)) {
        assert!(escaped(Path::new(&format!("a{c}b"))).is_err(), "{c:?}");
    }
    for name in ["~a/b", "a ", "lib(b)"] {
        assert!(escaped(Path::new(name)).is_err(), "{name}");
    }
    assert!(target(Path::new("50%.gltf")).is_err());
}
