use super::*;

fn error(pattern: &str) -> String {
    globs(&[pattern.to_owned()]).expect_err(pattern).to_string()
}

#[test]
fn globs_of_any_size_are_compiled_or_refused() {
    let nested = |depth: usize| format!("{}a{}", "{a,".repeat(depth), "}".repeat(depth));
    assert!(globs(&[nested(MAX_NESTING)]).is_ok());
    assert!(globs(&vec!["?".repeat(MAX_BYTES); 10]).is_ok_and(|set| set.len() == 10));
    assert!(error(&nested(150)).contains("found 150 in \"{a,{a,"), "{}", error(&nested(150)));
    assert!(error(&"?".repeat(200_000)).contains("found one of 200000: \"???"));
    assert!(error("[z-a]").contains("found \"[z-a]\": invalid range"), "{}", error("[z-a]"));
    let many = vec!["[!a]*".repeat(MAX_BYTES / 5); 1000];
    assert!(matches!(globs(&many), Err(GlobError::TooLarge { count: 1000, .. })));
}
