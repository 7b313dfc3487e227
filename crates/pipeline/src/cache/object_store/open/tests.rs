use super::*;

#[test]
fn accepts_schemes_of_stores_and_rejects_others() {
    let (_, path) = open("file:///a/b%20c").expect("a folder");
    assert_eq!(path.as_ref(), "a/b c");
    let (_, path) = open("s3://bucket/some/prefix").expect("a bucket");
    assert_eq!(path.as_ref(), "some/prefix");
    for wrong in ["://", "s3://", "http://host/a", "https://host/a", "memory:///a", "ftp://host/a", "C://x"] {
        assert!(matches!(open(wrong), Err(CacheError::NoStore { .. })), "{wrong}");
    }
}

#[test]
fn rejects_secrets_in_a_url_without_repeating_them() {
    for wrong in ["s3://user:hunter2@bucket/a", "az://container/a?sig=hunter2", "s3://bucket/a#hunter2"] {
        let error = open(wrong).map(|_| ()).expect_err("an error").to_string();
        assert!(error.contains("credentials") && !error.contains("hunter2"), "{error}");
    }
}
