use super::*;

#[test]
fn printable_text_is_unchanged() {
    let text = "brick (2) \u{e9}\u{65e5}\u{672c} \\u{1b} ::error::";
    assert!(matches!(printable(text), Cow::Borrowed(same) if same == text));
}

#[test]
fn xml_has_no_markup_and_no_control_characters() {
    assert_eq!(xml_escaped("<a b=\"c\">&\u{1}\n\u{ffff}é"), "&lt;a b=&quot;c&quot;&gt;&amp;\u{fffd}\n\u{fffd}é");
}

#[test]
fn characters_that_terminals_act_on_are_escaped() {
    assert_eq!(printable("\u{1b}]0;x\u{7}"), "\\u{1b}]0;x\\u{7}");
    assert_eq!(printable("a\n::error::\r\t\u{7f}"), "a\\u{a}::error::\\u{d}\\u{9}\\u{7f}");
    assert_eq!(printable("\u{9b}\u{2028}\u{202e}\u{2069}"), "\\u{9b}\\u{2028}\\u{202e}\\u{2069}");
}
