use super::*;

fn denied() -> Error {
    Error::PermissionDenied { path: "a".to_owned(), source: "<Key>secret</Key>".into() }
}

fn unreachable() -> Error {
    Error::Generic { store: "S3", source: "refused: <Key>secret</Key>".into() }
}

#[test]
fn an_unreachable_store_is_reported_once_and_paused() {
    let health = Health::default();
    assert!(health.is_available() && health.is_writable());
    let error = health.get_failed("s3://a", &unreachable()).expect_err("a warning");
    assert_eq!(
        error.to_string(),
        "s3://a: expected a store that answers, found: refused; the bake goes on without the store"
    );
    assert!(!health.is_available() && !health.is_writable());
    let later = [health.get_failed("s3://a", &unreachable()), health.put_failed("s3://a", &unreachable())];
    assert!(later.iter().all(Result::is_ok));
    *health.paused_until.lock().expect("a lock") = Some(Instant::now());
    assert!(health.is_available() && health.is_writable());
}

#[test]
fn a_store_that_refuses_objects_is_read_only() {
    let health = Health::default();
    let error = health.put_failed("s3://a", &denied()).expect_err("a warning");
    assert!(matches!(&error, CacheError::ReadOnly { reason, .. } if reason == "no permission"), "{error}");
    assert!(health.is_available() && !health.is_writable());
    assert!(health.put_failed("s3://a", &denied()).is_ok());
}
