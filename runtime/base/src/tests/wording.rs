//! Unit tests of `wording`.

use super::*;

#[test]
fn what_would_act_on_a_terminal_is_visible() {
    let rows = [
        ("plain, é and 布", "plain, é and 布"),
        ("  two\nlines\t", "two\\nlines"),
        ("\u{1b}[31mred", "\\u{1b}[31mred"),
        ("a\u{202e}b", "a\\u{202e}b"),
        ("\0", "\\u{0}"),
    ];
    for (text, expected) in rows {
        assert_eq!(shown(text, 300), expected);
    }
    assert_eq!(shown("12345", 3), "123…");
    assert_eq!(shown("123", 3), "123");
}
