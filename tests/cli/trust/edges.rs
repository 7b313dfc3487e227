//! The borders of the command line: readers of its messages, untrusted names and settings, and the programs that it
//! starts.

mod depfile;
#[cfg(target_os = "linux")]
mod hook;
mod names;
#[cfg(target_os = "linux")]
mod streams;

use std::fs;

use tempfile::tempdir;

use crate::process::{bake, copy, done, fixtures, hashes, roughcast_with, run};

#[test]
fn a_glob_of_any_size_gives_one_error() {
    let nested = format!("{}a{}", "{a,".repeat(150), "}".repeat(150));
    for (glob, part) in [
        (nested.as_str(), "found 150 in"),
        (&"?".repeat(200_000), "found one of 200000"),
        (&"{".repeat(100_000), "found one of 100000"),
        ("[z-a]", "\"[z-a]\": invalid range"),
    ] {
        let folder = tempdir().expect("a folder");
        copy(&fixtures().join("waves"), &folder.path().join("A"));
        let config = format!("model = 'none'\n[[override]]\nfiles = '{glob}'\n");
        fs::write(folder.path().join("A/roughcast.toml"), config).expect("a file");
        let run = run(folder.path(), "bake A -o O");
        assert_eq!((run.code, run.err.lines().count()), (2, 1), "{}", run.err);
        assert!(run.err.starts_with("error: A/roughcast.toml: line 3: files: expected "), "{}", run.err);
        assert!(run.err.contains(part) && run.err.len() < 400, "{}", run.err);
    }
}

#[test]
fn the_number_of_threads_is_limited() {
    let folder = tempdir().expect("a folder");
    let [usual, many] = ["usual", "many"].map(|name| folder.path().join(name));
    bake(&fixtures().join("waves"), &usual, &["--model=none"]);
    let waves = fixtures().join("waves");
    let line = ["bake".as_ref(), waves.as_os_str(), "-o".as_ref(), many.as_os_str(), "--model=none".as_ref()];
    for (variables, flags, name) in [
        (&[][..], &["--threads", "1000000"][..], "--threads"),
        (&[("RAYON_NUM_THREADS", "1000000")], &[], "RAYON_NUM_THREADS"),
    ] {
        let run = roughcast_with(variables, folder.path(), line.into_iter().chain(flags.iter().map(AsRef::as_ref)));
        assert_eq!((run.code, run.err.lines().count()), (0, 1), "{}", run.err);
        assert!(run.err.starts_with(&format!("warning: {name}: expected at most ")), "{}", run.err);
        assert_eq!(hashes(&many), hashes(&usual));
    }
    for threads in ["--threads 0", "--threads 64"] {
        done(folder.path(), &format!("completions bash {threads}"));
    }
}

#[cfg(unix)]
#[test]
fn an_asset_may_have_a_name_that_no_uri_can_contain() {
    let checked = |name: &str, textures: &str| {
        let folder = tempdir().expect("a folder");
        fs::create_dir(folder.path().join("A")).expect("a folder");
        fs::copy(fixtures().join("waves/waves.glb"), folder.path().join("A").join(name)).expect("a file");
        done(folder.path(), "bake A -o O --model none --glb=false");
        assert!(folder.path().join("O").join(name).with_extension("gltf").is_file(), "{name}");
        assert!(folder.path().join("O").join(textures).is_dir(), "{name}");
        let check = run(folder.path(), "check O --source A");
        (check.code, check.out.lines().count(), check.err)
    };
    let usual = checked("waves.glb", "waves.roughcast");
    assert_eq!(checked("a:b.glb", "a_b.roughcast"), usual);
    assert_eq!(checked("c\\d:.glb", "c_d_.roughcast"), usual);
}
