use super::*;

impl Look {
    /// Returns the look of a file of `bytes` that was modified at `modified`.
    pub(in crate::watch) fn new(bytes: u64, modified: SystemTime) -> Self {
        Self { bytes, modified: Some(modified), inode: Inode::default() }
    }
}

fn at(seconds: u64) -> SystemTime {
    SystemTime::UNIX_EPOCH + Duration::from_secs(seconds)
}

#[test]
fn an_old_file_that_looks_equal_is_unchanged() {
    let look = Some(Look::new(10, at(100)));
    assert!(Seen::new(look, true, at(103)).is_unchanged(look));
    assert!(!Seen::new(look, true, at(103)).is_unchanged(Some(Look::new(11, at(100)))));
    assert!(!Seen::new(look, true, at(103)).is_unchanged(Some(Look::new(10, at(99)))));
    assert!(!Seen::new(look, true, at(103)).is_unchanged(None));
    assert!(Seen::new(None, false, at(103)).is_unchanged(None));
}

#[test]
fn a_file_may_change_within_the_resolution_of_its_time() {
    let look = Some(Look::new(10, at(100)));
    for since in [98, 100, 102] {
        let seen = Seen::new(look, true, at(since));
        assert!(!seen.is_unchanged(look) && seen.looks_like(look), "{since}");
    }
}

#[test]
fn a_file_that_came_or_went_while_it_was_read_is_read_again() {
    let look = Some(Look::new(10, at(100)));
    assert!(!Seen::new(look, false, at(200)).is_unchanged(look));
    assert!(!Seen::new(None, true, at(200)).is_unchanged(None));
}

#[cfg(unix)]
#[test]
fn a_file_that_an_older_one_replaced_is_read_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let (path, other) = (folder.path().join("a"), folder.path().join("b"));
    fs::write(&path, "read").expect("a file");
    let since = SystemTime::now();
    fs::write(&other, "unread").expect("a file");
    let file = fs::File::options().write(true).open(&other).expect("a file");
    file.set_modified(since - Duration::from_secs(3600)).expect("a time");
    fs::rename(&other, &path).expect("a file");
    let look = Look::at(&path);
    assert!(!Seen::new(look, true, since).is_unchanged(look));
}
