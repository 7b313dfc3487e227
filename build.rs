//! Embeds the page of `roughcast view` in the tool, if ROUGHCAST_VIEWER names the folder that `npm/make-viewer.js`
//! wrote.
//!
//! The page holds three.js, which no build by Cargo can fetch, so that builds without the variable have no page. The
//! files get into the tool as they are, since wheels and archives are compressed anyway.

use std::error::Error;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::{env, fs};

const VARIABLE: &str = "ROUGHCAST_VIEWER";

/// What the folder has for the browser. The rest of the folder is for Node.
const PARTS: [&str; 3] = ["page", "three", "LICENSES.md"];

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed={VARIABLE}");
    let page = match env::var_os(VARIABLE) {
        Some(folder) if !folder.is_empty() => format!("Some(&{})", page_files(Path::new(&folder))?),
        _ => "None".to_owned(),
    };
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or("Cargo sets OUT_DIR")?);
    fs::write(out.join("viewer_page.rs"), page)?;
    Ok(())
}

/// Returns the files of the page as a Rust array of `PageFile`.
fn page_files(folder: &Path) -> Result<String, Box<dyn Error>> {
    let complaint = |found: &dyn std::fmt::Display| {
        format!(
            "{VARIABLE}={}: expected the folder that `node npm/make-viewer.js` wrote, found: {found}; unset {VARIABLE} \
             for a build without the page",
            folder.display()
        )
    };
    // Cargo runs build scripts in the folder of the package, and the compiler resolves paths elsewhere.
    let folder = folder.canonicalize().map_err(|error| complaint(&error))?;
    if !folder.join("page/index.html").is_file() {
        return Err(complaint(&"no page/index.html").into());
    }
    let mut files = Vec::new();
    for part in PARTS {
        // Cargo looks into folders, too.
        println!("cargo::rerun-if-changed={}", folder.join(part).display());
        collect(&folder.join(part), part, &mut files).map_err(|error| complaint(&format!("{part}: {error}")))?;
    }
    files.sort();
    let mut array = "[\n".to_owned();
    for (url, path) in files {
        let path = path.to_str().ok_or_else(|| complaint(&"a path that is not UTF-8"))?;
        writeln!(array, "    PageFile {{ path: {url:?}, bytes: include_bytes!({path:?}) }},")?;
    }
    Ok(array + "]")
}

/// Adds the file at `path`, or the files below it, with their paths in URLs.
fn collect(path: &Path, url: &str, files: &mut Vec<(String, PathBuf)>) -> std::io::Result<()> {
    if path.is_file() {
        files.push((url.to_owned(), path.to_owned()));
        return Ok(());
    }
    for entry in fs::read_dir(path)? {
        let entry = entry?;
        collect(&entry.path(), &format!("{url}/{}", entry.file_name().to_string_lossy()), files)?;
    }
    Ok(())
}
