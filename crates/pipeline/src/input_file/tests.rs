use super::*;

#[test]
fn ordinary_files_are_read_and_hashed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    fs::write(&path, b"what it holds").unwrap();
    assert_eq!(read_file(&path).unwrap(), b"what it holds");
    assert_eq!(hash_file(&path).unwrap(), (crate::digest::digest(b"what it holds"), 13));
    assert_eq!(check_file(&path).unwrap(), 13);
}

#[test]
fn folders_and_missing_files_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(read_file(folder.path()).unwrap_err().kind(), io::ErrorKind::IsADirectory);
    assert_eq!(read_file(&folder.path().join("a")).unwrap_err().kind(), io::ErrorKind::NotFound);
}

/// Hangs if it fails.
#[test]
#[cfg(unix)]
fn sockets_devices_and_links_to_them_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let socket = folder.path().join("socket");
    let _listening = std::os::unix::net::UnixListener::bind(&socket).unwrap();
    let link = folder.path().join("link");
    std::os::unix::fs::symlink("/dev/zero", &link).unwrap();
    for path in [&socket, &link, Path::new("/dev/null")] {
        assert_eq!(open_file(path).unwrap_err().kind(), io::ErrorKind::InvalidInput, "{}", path.display());
        assert!(hash_file(path).is_err() && read_file(path).is_err());
    }
}

#[test]
fn refuses_files_larger_than_8_gib() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sparse");
    File::create(&path).unwrap().set_len(MAX_FILE_BYTES + 1).unwrap();
    assert_eq!(read_file(&path).unwrap_err().kind(), io::ErrorKind::FileTooLarge);
}
