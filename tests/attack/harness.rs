//! The harness: runs an entry point on many damaged inputs, with a time limit for each.

use std::env;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use super::random::Random;

/// Number of cases of each entry in a run without ROUGHCAST_ATTACK_ROUNDS.
const CASES: u64 = 20_000;

/// Time limit of a case. Cases take milliseconds, and are several times slower on a loaded machine.
const HANG: Duration = Duration::from_secs(120);

/// A function that damages an input.
pub type Mutate = fn(&mut Random, &mut Vec<u8>);

/// Runs `entry` on the cases that once failed, and on `seeds`, each damaged by up to four mutations.
///
/// # Panics
/// Panics if a case panics or hangs. The message names a file with the case.
pub fn attack(name: &str, entry: fn(&[u8]), seeds: &[Vec<u8>], mutate: Mutate) {
    for (path, case) in found(name) {
        run(&format!("{}", path.display()), entry, case);
    }
    let rounds: u64 = env::var("ROUGHCAST_ATTACK_ROUNDS").ok().and_then(|rounds| rounds.parse().ok()).unwrap_or(1);
    for seed in 0..CASES * rounds {
        let mut random = Random::new(seed);
        let mut case = random.pick(seeds).clone();
        for _ in 0..=random.below(4) {
            mutate(&mut random, &mut case);
        }
        run(&format!("{name}, seed {seed}"), entry, case);
    }
}

/// Reads the cases in `tests/attack/found/<name>`.
fn found(name: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/attack/found").join(name);
    let files = fs::read_dir(folder).into_iter().flatten().map(|file| file.expect("a file").path());
    files.map(|path| (path.clone(), fs::read(path).expect("a readable file"))).collect()
}

fn run(name: &str, entry: fn(&[u8]), case: Vec<u8>) {
    let (sender, receiver) = mpsc::channel();
    let kept = case.clone();
    // A case that hangs keeps its thread, but the test fails at once.
    thread::spawn(move || sender.send(catch_unwind(AssertUnwindSafe(|| entry(&case))).is_ok()));
    let problem = match receiver.recv_timeout(HANG) {
        Ok(true) => return,
        Ok(false) | Err(RecvTimeoutError::Disconnected) => "panics",
        Err(RecvTimeoutError::Timeout) => "hangs",
    };
    let path = env::temp_dir().join(format!("roughcast-attack-{}", blake3::hash(&kept).to_hex()));
    fs::write(&path, kept).expect("a writable temporary folder");
    panic!("{name} {problem}; the case is in {}", path.display());
}
