use proptest::prelude::*;

use super::*;

#[test]
fn accepts_names_below_a_folder() {
    for text in ["a", "a.gltf", "a.roughcast/b c.ktx2", "..a/b..", "ä/ö", "..."] {
        let path = RelativePath::try_from(text.to_owned()).expect(text);
        assert_eq!((path.as_path(), RelativePath::try_from(Path::new(text))), (Path::new(text), Ok(path.clone())));
        let json = serde_json::to_value(&path).expect("JSON");
        assert_eq!((json.as_str(), serde_json::from_value(json.clone()).ok()), (Some(text), Some(path)));
    }
}

#[test]
fn rejects_paths_that_leave_the_folder() {
    for text in ["", ".", "..", "/", "/a", "a/", "a//b", "./a", "a/./b", "../a", "a/..", "a/../../b", "a\0b"] {
        assert!(RelativePath::try_from(text.to_owned()).is_err(), "{text:?}");
        assert!(serde_json::from_value::<RelativePath>(text.into()).is_err(), "{text:?}");
    }
    for text in ["", ".", "..", "/a", "../a", "a/../b"] {
        assert!(RelativePath::try_from(Path::new(text)).is_err(), "{text:?}");
    }
    for text in ["C:a", "C:\\a", "\\\\host\\a", "a\\..\\..\\b", "a:b", ".. "] {
        assert_eq!(RelativePath::try_from(text.to_owned()).is_err(), cfg!(windows), "{text:?}");
    }
}

#[cfg(unix)]
#[test]
fn rejects_names_that_are_not_utf_8() {
    use std::os::unix::ffi::OsStrExt;
    let path = Path::new(std::ffi::OsStr::from_bytes(b"a/\xff"));
    assert!(RelativePath::try_from(path).is_err());
}

proptest! {
    #[test]
    fn accepted_paths_stay_below_the_folder(text in "[a./\\\\: \\PC]{0,12}") {
        if let Ok(path) = RelativePath::try_from(text.clone()) {
            let parts: Vec<Component> = path.as_path().components().collect();
            prop_assert!(!parts.is_empty() && parts.iter().all(|part| matches!(part, Component::Normal(_))));
            prop_assert!(Path::new("folder").join(path.as_path()).starts_with("folder"));
        }
    }
}
