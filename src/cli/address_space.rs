//! How much address space the process may still take.

use std::fs;
use std::sync::LazyLock;

/// The limit, which was set before the process began.
static LIMIT: LazyLock<Option<u64>> = LazyLock::new(|| number_after("/proc/self/limits", "Max address space"));

/// Returns how many bytes the process may still take of its address space. None without a limit (`ulimit -v`), and on
/// systems other than Linux.
pub fn left() -> Option<u64> {
    let limit = (*LIMIT)?;
    let taken = number_after("/proc/self/status", "VmSize:")?;
    Some(limit.saturating_sub(taken << 10))
}

/// Returns the number that follows `name` at the start of a line of the file at `path`.
fn number_after(path: &str, name: &str) -> Option<u64> {
    let text = fs::read_to_string(path).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse().ok()
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn reads_how_much_is_taken() {
        let taken = number_after("/proc/self/status", "VmSize:").expect("a number");
        // Threads of other tests that end meanwhile give back 64 MiB each, which this block must exceed.
        let block: Vec<u8> = Vec::with_capacity(2 << 30);
        let more = number_after("/proc/self/status", "VmSize:").expect("a number");
        assert!(more >= taken + (1 << 20), "{taken} KiB, then {more} KiB with {} bytes more", block.capacity());
        assert_eq!(number_after("/proc/self/status", "No such name"), None);
    }
}
