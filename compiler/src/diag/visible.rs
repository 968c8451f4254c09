//! Makes characters visible that a terminal would act on.

use std::borrow::Cow;

/// Returns whether a character is a control character other than a line end or a tab, or turns the direction of
/// writing (Unicode's `Bidi_Control`).
pub fn is_hidden(character: char) -> bool {
    turns_writing(character) || character.is_control() && !matches!(character, '\n' | '\r' | '\t')
}

/// Returns whether a character turns the direction of writing, so that a text reads other than it is.
pub(crate) fn turns_writing(character: char) -> bool {
    matches!(
        character,
        '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
    )
}

/// Writes hidden characters as `\u{1b}`, so that foreign text cannot change what a terminal shows.
pub fn visible(text: &str) -> Cow<'_, str> {
    escaped_where(text, is_hidden)
}

/// Writes some characters as `\u{1b}`.
pub(super) fn escaped_where(text: &str, is_escaped: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.chars().any(&is_escaped) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len());
    for character in text.chars() {
        match is_escaped(character) {
            true => shown.extend(character.escape_unicode()),
            false => shown.push(character),
        }
    }
    Cow::Owned(shown)
}

#[cfg(test)]
mod tests {
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
}
