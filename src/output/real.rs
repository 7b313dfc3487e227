//! Where a path leads once everything on it exists.

use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

/// As many links on one path as Linux follows.
const MOST_LINKS: usize = 40;

/// Returns `path` without links and dots, as the file system will resolve it once all of it exists.
///
/// What exists is resolved by the file system. A part that does not exist will be made as a folder, not as a link, so a
/// `..` behind it leads back to where it is made: `missing/../assets` is `assets`. A link to a path that does not exist is
/// followed.
///
/// # Errors
/// The system's, such as for links that lead in a circle and for folders that may not be searched.
pub fn real(path: &Path) -> io::Result<PathBuf> {
    let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
    match fs::canonicalize(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        result => return result,
    }
    let mut real = if path.is_absolute() { PathBuf::new() } else { fs::canonicalize(".")? };
    follow(&mut real, path, &mut 0)?;
    Ok(real)
}

/// Goes from the folder `real` along `path`.
fn follow(real: &mut PathBuf, path: &Path, links: &mut usize) -> io::Result<()> {
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => {
                real.pop();
            }
            Component::Prefix(_) | Component::RootDir => real.push(part),
            Component::Normal(name) => {
                let named = real.join(name);
                match fs::canonicalize(&named) {
                    Ok(found) => *real = found,
                    Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                    Err(error) => match fs::read_link(&named) {
                        Ok(_) if *links == MOST_LINKS => return Err(error),
                        Ok(target) => {
                            *links += 1;
                            follow(real, &target, links)?;
                        }
                        Err(_) => *real = named,
                    },
                }
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_is_resolved_as_it_will_be_made() {
        let folder = tempfile::tempdir().expect("a folder");
        let folder = fs::canonicalize(folder.path()).expect("a folder");
        fs::create_dir(folder.join("assets")).expect("a folder");
        for (path, leads_to) in [
            ("assets", "assets"),
            ("assets/../assets/./", "assets"),
            ("build/../assets", "assets"),
            ("build/x/../../assets/new", "assets/new"),
            ("assets/new/../../build", "build"),
        ] {
            assert_eq!(real(&folder.join(path)).expect("a path"), folder.join(leads_to), "{path}");
        }
        assert_eq!(real(Path::new("no-such-folder/..")).ok(), fs::canonicalize(".").ok());
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_whether_or_not_they_lead_to_something() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().expect("a folder");
        let folder = fs::canonicalize(folder.path()).expect("a folder");
        fs::create_dir_all(folder.join("a/b")).expect("a folder");
        symlink("a/b", folder.join("there")).expect("a link");
        symlink("a/c", folder.join("missing")).expect("a link");
        symlink("circle", folder.join("circle")).expect("a link");
        assert_eq!(real(&folder.join("there/../x")).expect("a path"), folder.join("a/x"));
        assert_eq!(real(&folder.join("new/../missing/x")).expect("a path"), folder.join("a/c/x"));
        assert!(real(&folder.join("circle/x")).is_err());
    }
}
