//! Resolution of paths whose parts need not exist yet.

use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

/// Number of links that Linux follows on one path.
const MOST_LINKS: usize = 40;

/// Returns `path` without links and dots, as the file system will resolve it once all of it exists.
///
/// The file system resolves the parts that exist. A missing part will be made as a folder, not as a link, so a `..`
/// after it cancels it: `missing/../assets` is `assets`. A link to a missing path is followed.
///
/// # Errors
/// The system's, such as for links that form a loop and for folders that may not be searched.
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

/// Returns whether two paths lead to one file.
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    a == b || matches!((fs::canonicalize(a), fs::canonicalize(b)), (Ok(a), Ok(b)) if a == b)
}

/// Follows `path` from the folder `real`, which becomes the resolved path.
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
mod tests;
