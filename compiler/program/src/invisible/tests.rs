//! Tests what a terminal is shown of foreign text.

use super::visible;

#[test]
fn hidden_characters_are_written_by_their_numbers() {
    for (text, expected) in [
        ("plain\ttext\r\n", "plain\ttext\r\n"),
        ("é 🧺 عربي", "é 🧺 عربي"),
        ("a\0b", "a\\u{0}b"),
        ("\x1b[2Jgone", "\\u{1b}[2Jgone"),
        ("\u{9b}31m", "\\u{9b}31m"),
        ("\u{7f}\u{8}", "\\u{7f}\\u{8}"),
        ("ab\u{202e}cd\u{2069}", "ab\\u{202e}cd\\u{2069}"),
        ("\u{200f}\u{61c}", "\\u{200f}\\u{61c}"),
    ] {
        assert_eq!(visible(text), expected);
    }
}
