use std::time::SystemTime;

use super::*;

#[test]
fn a_file_settles_when_it_does_not_change_for_the_window() {
    let (start, path) = (Instant::now(), Path::new("a.png"));
    let at = |ms| start + Duration::from_millis(ms);
    let look = |bytes| Some(Look::new(bytes, SystemTime::UNIX_EPOCH));
    let mut settling = Settling::new(Duration::from_millis(50));
    for (ms, look, is_settled) in [
        (0, look(1), false),
        (40, look(1), false),
        (45, look(2), false),
        (94, look(2), false),
        (95, look(2), true),
        (96, None, false),
        (120, look(3), false),
        (169, look(3), false),
        (170, look(3), true),
    ] {
        assert_eq!(settling.is_settled(path, look, at(ms)), is_settled, "at {ms} ms");
    }
}

#[test]
fn files_settle_independently() {
    let (start, window) = (Instant::now(), Duration::from_millis(50));
    let mut settling = Settling::new(window);
    let look = Some(Look::new(1, SystemTime::UNIX_EPOCH));
    settling.is_settled(Path::new("a"), look, start);
    settling.is_settled(Path::new("b"), look, start + window / 2);
    assert_eq!(settling.pending(start), Some(start + window));
    assert!(settling.is_settled(Path::new("a"), look, start + window));
    assert!(!settling.is_settled(Path::new("b"), look, start + window));
    assert_eq!(settling.pending(start + window), Some(start + window / 2 + window));
    assert_eq!(settling.pending(start + 2 * window), None);
}
