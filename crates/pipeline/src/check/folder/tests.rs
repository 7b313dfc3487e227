use std::fs;

use super::*;

#[test]
fn reads_parts_of_ordinary_files_and_rejects_everything_else() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("file"), "0123456789").unwrap();
    let files = Folder(folder.path().to_owned());
    let file = Path::new("file");
    assert_eq!(files.length(file).unwrap(), 10);
    assert_eq!(files.read(file, 3..7).unwrap(), b"3456");
    assert_eq!(files.read(file, 7..11).unwrap_err().kind(), io::ErrorKind::UnexpectedEof);
    for path in [".", "no such file"].map(Path::new) {
        assert!(files.length(path).is_err() && files.read(path, 0..1).is_err());
    }
}
